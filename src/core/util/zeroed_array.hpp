#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
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
  explicit ZeroedArray(std::uint64_t size)
      : numbers_(static_cast<Number*>(std::calloc(size, sizeof(Number)))), size_(size) {
    if (numbers_ == nullptr && size > 0) throw std::bad_alloc();
  }

  Number& operator[](std::size_t i) { return numbers_.get()[i]; }
  const Number& operator[](std::size_t i) const { return numbers_.get()[i]; }
  std::uint64_t allocated_bytes() const { return size_ * sizeof(Number); }

 private:
  struct Free {
    void operator()(Number* numbers) const { std::free(numbers); }
  };
  std::unique_ptr<Number, Free> numbers_;
  std::uint64_t size_ = 0;
};

}  // namespace clearway
