#pragma once

#include <bit>
#include <cstdint>

#include "core/util/macros.hpp"

namespace clearway {

/// The lanes whose value is at most `limit` or not a number, as bits.
template <std::uint32_t kLanes>
CLEARWAY_HD std::uint32_t lanes_within(const float (&values)[kLanes], float limit) {
  static_assert(kLanes <= 32);
  std::uint32_t bits = 0;
  for (std::uint32_t i = 0; i < kLanes; ++i) {
    bits |= static_cast<std::uint32_t>(!(values[i] > limit)) << i;
  }
  return bits;
}

/// The lane of the least of values that are not negative; of nearly equal ones, the first.
template <std::uint32_t kLanes>
CLEARWAY_HD std::uint32_t least_lane(const float (&values)[kLanes]) {
#ifdef __CUDA_ARCH__
  std::uint32_t least = 0;
  for (std::uint32_t i = 1; i < kLanes; ++i) {
    if (values[i] < values[least]) least = i;
  }
  return least;
#else
  // Floats that are not negative are in the order of their bits, the last of which are replaced by
  // the lane, so that the compiler can compare several at once.
  static_assert(std::has_single_bit(kLanes));
  std::int32_t least = 0x7fffffff;
  for (std::uint32_t i = 0; i < kLanes; ++i) {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(values[i]);
    const auto key = static_cast<std::int32_t>((bits & ~(kLanes - 1)) | i);
    least = key < least ? key : least;
  }
  return static_cast<std::uint32_t>(least) & (kLanes - 1);
#endif
}

}  // namespace clearway
