#pragma once

#include <bit>
#include <cstdint>

#include "core/util/macros.hpp"

#if defined(__SSE2__) && !defined(__CUDA_ARCH__)
#include <emmintrin.h>
#endif

namespace clearway {

/// The lanes whose value is at most `limit` or not a number, as bits. The vectors are those that
/// every x86-64 processor has, because a compiler compares the values one by one.
template <typename Real, std::uint32_t kLanes>
CLEARWAY_HD std::uint32_t lanes_within(const Real (&values)[kLanes], Real limit) {
  static_assert(kLanes <= 32 && kLanes % 4 == 0);
  std::uint32_t bits = 0;
#if defined(__SSE2__) && !defined(__CUDA_ARCH__)
  constexpr std::uint32_t kWidth = 16 / sizeof(Real);
  for (std::uint32_t i = 0; i < kLanes; i += kWidth) {
    int mask;
    if constexpr (sizeof(Real) == sizeof(float)) {
      mask = _mm_movemask_ps(_mm_cmpngt_ps(_mm_loadu_ps(values + i), _mm_set1_ps(limit)));
    } else {
      mask = _mm_movemask_pd(_mm_cmpngt_pd(_mm_loadu_pd(values + i), _mm_set1_pd(limit)));
    }
    bits |= static_cast<std::uint32_t>(mask) << i;
  }
#else
  for (std::uint32_t i = 0; i < kLanes; ++i) {
    bits |= static_cast<std::uint32_t>(!(values[i] > limit)) << i;
  }
#endif
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
