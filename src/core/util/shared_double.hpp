#pragma once

#ifndef __CUDA_ARCH__
#include <atomic>
#endif

#include "core/util/macros.hpp"

/// Functions for doubles that threads of a device, or of the host, read and write at the same time,
/// in no particular order.
namespace clearway {

CLEARWAY_HD inline double load_shared(const double* value) {
#ifdef __CUDA_ARCH__
  return *static_cast<const volatile double*>(value);
#else
  return std::atomic_ref(*const_cast<double*>(value)).load(std::memory_order_relaxed);
#endif
}

CLEARWAY_HD inline void store_shared(double* value, double to) {
#ifdef __CUDA_ARCH__
  *static_cast<volatile double*>(value) = to;
#else
  std::atomic_ref(*value).store(to, std::memory_order_relaxed);
#endif
}

/// Lowers a value; neither the value nor `to` is negative.
CLEARWAY_HD inline void lower_shared(double* value, double to) {
#ifdef __CUDA_ARCH__
  // Doubles that are not negative have the order of their bits.
  atomicMin(reinterpret_cast<unsigned long long*>(value),
            static_cast<unsigned long long>(__double_as_longlong(to)));
#else
  std::atomic_ref target(*value);
  double seen = target.load(std::memory_order_relaxed);
  while (to < seen && !target.compare_exchange_weak(seen, to, std::memory_order_relaxed)) {
  }
#endif
}

/// Lowers a value to one that is below 0.
CLEARWAY_HD inline void lower_shared_below_0(double* value, double to) {
#ifdef __CUDA_ARCH__
  auto* const bits = reinterpret_cast<unsigned long long*>(value);
  const auto wanted = static_cast<unsigned long long>(__double_as_longlong(to));
  for (double seen = load_shared(value); to < seen;) {
    const auto expected = static_cast<unsigned long long>(__double_as_longlong(seen));
    seen = __longlong_as_double(static_cast<long long>(atomicCAS(bits, expected, wanted)));
  }
#else
  lower_shared(value, to);
#endif
}

}  // namespace clearway
