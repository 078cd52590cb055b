#pragma once

#include <bit>
#include <cstdint>

#include "core/util/macros.hpp"

#ifndef __CUDA_ARCH__
#include <atomic>
#endif

/// Functions for the bits of a word, and for words that the threads of a device share.
namespace clearway {

/// Ors bits into a word into which other threads of a device or bits at the same time.
CLEARWAY_HD inline void or_into(std::uint64_t* word, std::uint64_t bits) {
#ifdef __CUDA_ARCH__
  atomicOr(reinterpret_cast<unsigned long long*>(word), static_cast<unsigned long long>(bits));
#else
  *word |= bits;
#endif
}

/// Reads a word in which other threads, of the host or of a device, clear bits at the same time. On
/// a device the value may be older than what another thread has cleared.
CLEARWAY_HD inline std::uint64_t shared_word(const std::uint64_t* word) {
#ifdef __CUDA_ARCH__
  return *word;
#else
  return std::atomic_ref(*const_cast<std::uint64_t*>(word)).load(std::memory_order_relaxed);
#endif
}

/// Clears bits of a word in which other threads, of the host or of a device, clear bits at the same
/// time.
CLEARWAY_HD inline void clear_in(std::uint64_t* word, std::uint64_t bits) {
#ifdef __CUDA_ARCH__
  atomicAnd(reinterpret_cast<unsigned long long*>(word), static_cast<unsigned long long>(~bits));
#else
  std::atomic_ref(*word).fetch_and(~bits, std::memory_order_relaxed);
#endif
}

/// Lowers a value that other threads of a device lower at the same time.
CLEARWAY_HD inline void lower_to(std::uint32_t* value, std::uint32_t to) {
#ifdef __CUDA_ARCH__
  atomicMin(value, to);
#else
  if (to < *value) *value = to;
#endif
}

/// Lowers a value that other threads, of the host or of a device, lower at the same time. Returns
/// the value before.
CLEARWAY_HD inline std::uint32_t lower_shared(std::uint32_t* value, std::uint32_t to) {
#ifdef __CUDA_ARCH__
  return atomicMin(value, to);
#else
  const std::atomic_ref shared(*value);
  std::uint32_t before = shared.load(std::memory_order_relaxed);
  while (to < before && !shared.compare_exchange_weak(before, to, std::memory_order_relaxed)) {
  }
  return before;
#endif
}

/// Reads a value that other threads, of the host or of a device, lower at the same time. It may be
/// greater than what another thread has made it.
CLEARWAY_HD inline std::uint32_t shared_value(const std::uint32_t* value) {
#ifdef __CUDA_ARCH__
  return *reinterpret_cast<const volatile std::uint32_t*>(value);
#else
  return std::atomic_ref(*const_cast<std::uint32_t*>(value)).load(std::memory_order_relaxed);
#endif
}

/// Index of the lowest set bit, of which there must be one.
CLEARWAY_HD inline std::uint32_t lowest_bit(std::uint64_t bits) {
#ifdef __CUDA_ARCH__
  return static_cast<std::uint32_t>(__ffsll(static_cast<long long>(bits)) - 1);
#else
  return static_cast<std::uint32_t>(std::countr_zero(bits));
#endif
}

/// Number of set bits.
CLEARWAY_HD inline std::uint32_t count_of(std::uint64_t bits) {
#ifdef __CUDA_ARCH__
  return static_cast<std::uint32_t>(__popcll(bits));
#else
  return static_cast<std::uint32_t>(std::popcount(bits));
#endif
}

}  // namespace clearway
