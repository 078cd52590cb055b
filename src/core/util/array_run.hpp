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

/// Arrays one after the other in one run of bytes, each on its values' alignment. It describes the
/// run before there is memory: what the arrays take and where they lie follow from it.
class ArrayRun {
 public:
  template <typename Value>
  ArrayPlace<Value> add(std::uint64_t count) {
    const std::uint64_t at = (bytes_ + alignof(Value) - 1) / alignof(Value) * alignof(Value);
    bytes_ = at + count * sizeof(Value);
    return {at, count};
  }

  std::uint64_t bytes() const { return bytes_; }

 private:
  std::uint64_t bytes_ = 0;
};

}  // namespace clearway
