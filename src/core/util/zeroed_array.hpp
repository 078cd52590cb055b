#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <type_traits>

namespace clearway {

/// An array of zeros. The system provides its memory when it is first touched, so that an array of
/// which little is used costs little, and the threads that use it share the work.
template <typename Number>
class ZeroedArray {
  static_assert(std::is_arithmetic_v<Number>);

 public:
  ZeroedArray() = default;
  explicit ZeroedArray(std::uint64_t size) : numbers_(map(size), {size}), size_(size) {}

  Number& operator[](std::size_t i) { return numbers_.get()[i]; }
  const Number& operator[](std::size_t i) const { return numbers_.get()[i]; }
  std::uint64_t size() const { return size_; }
  std::uint64_t allocated_bytes() const { return size_ * sizeof(Number); }

 private:
  struct Unmap {
    std::uint64_t size = 0;
    void operator()(Number* numbers) const { ::munmap(numbers, size * sizeof(Number)); }
  };

  /// Pages straight from the system. std::calloc would clear memory that was used before.
  static Number* map(std::uint64_t size) {
    if (size == 0) return nullptr;
    void* const pages = ::mmap(nullptr, size * sizeof(Number), PROT_READ | PROT_WRITE,
                               MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (pages == MAP_FAILED) throw std::bad_alloc();
    return static_cast<Number*>(pages);
  }

  std::unique_ptr<Number, Unmap> numbers_;
  std::uint64_t size_ = 0;
};

}  // namespace clearway
