#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace clearway {

/// Where `count` values lie in a run of bytes: `at` bytes from its begin.
template <typename Value>
struct ArrayPlace {
  std::uint64_t at, count;

  /// The values in a run that begins at `run`; no address where there are none.
  std::span<Value> in(std::byte* run) const {
    if (count == 0) return {};
    return {reinterpret_cast<Value*>(run + at), count};
  }
  std::span<const Value> in(const std::byte* run) const {
    if (count == 0) return {};
    return {reinterpret_cast<const Value*>(run + at), count};
  }
};

/// Arrays one after the other in one run of bytes, each on kAlignment. It describes the
/// run before there is memory: what the arrays take and where they lie follow from it.
class ArrayRun {
 public:
  /// That of an allocation of CUDA's own: warps read from it in whole lines.
  static constexpr std::uint64_t kAlignment = 256;

  template <typename Value>
  ArrayPlace<Value> add(std::uint64_t count) {
    static_assert(alignof(Value) <= kAlignment);
    if (count == 0) return {bytes_, 0};
    const std::uint64_t at = (bytes_ + kAlignment - 1) / kAlignment * kAlignment;
    bytes_ = at + count * sizeof(Value);
    return {at, count};
  }

  std::uint64_t bytes() const { return bytes_; }

 private:
  std::uint64_t bytes_ = 0;
};

}  // namespace clearway
