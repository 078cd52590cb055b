#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace clearway {

/// The place of `count` values in a run of bytes: `at` bytes from its beginning.
template <typename Value>
struct ArrayPlace {
  std::uint64_t at, count;

  /// The values in a run that begins at `run`; an empty span if there are none.
  std::span<Value> in(std::byte* run) const {
    if (count == 0) return {};
    return {reinterpret_cast<Value*>(run + at), count};
  }
  std::span<const Value> in(const std::byte* run) const {
    if (count == 0) return {};
    return {reinterpret_cast<const Value*>(run + at), count};
  }
};

/// Arrays one after another in one run of bytes, each aligned to kAlignment. It describes the run
/// before there is memory: it says how much memory the arrays take and where they lie.
class ArrayRun {
 public:
  /// Alignment of each array, that of CUDA's own allocations: warps read from it in whole lines.
  static constexpr std::uint64_t kAlignment = 256;

  /// Bytes rounded up to the alignment.
  static constexpr std::uint64_t aligned(std::uint64_t bytes) {
    return (bytes + kAlignment - 1) / kAlignment * kAlignment;
  }

  template <typename Value>
  ArrayPlace<Value> add(std::uint64_t count) {
    static_assert(alignof(Value) <= kAlignment);
    if (count == 0) return {bytes_, 0};
    const std::uint64_t at = aligned(bytes_);
    bytes_ = at + count * sizeof(Value);
    return {at, count};
  }

  std::uint64_t bytes() const { return bytes_; }

 private:
  std::uint64_t bytes_ = 0;
};

}  // namespace clearway
