#pragma once

#include <cstdint>

#include "core/util/macros.hpp"

namespace clearway {

inline constexpr std::uint32_t kWarpLanes = 32;

#ifdef __CUDACC__
/// The sum of the values of all lanes of a warp, and the least of them. All lanes must take part.
/// GPUs from the compute capability 8.0 on have an instruction for each.
__device__ inline std::uint32_t sum_of_lanes(std::uint32_t value) {
#if __CUDA_ARCH__ >= 800
  return __reduce_add_sync(0xffffffff, value);
#else
  for (int apart = kWarpLanes / 2; apart > 0; apart /= 2) {
    value += __shfl_xor_sync(0xffffffff, value, apart);
  }
  return value;
#endif
}
__device__ inline std::uint32_t least_of_lanes(std::uint32_t value) {
#if __CUDA_ARCH__ >= 800
  return __reduce_min_sync(0xffffffff, value);
#else
  for (int apart = kWarpLanes / 2; apart > 0; apart /= 2) {
    const std::uint32_t other = __shfl_xor_sync(0xffffffff, value, apart);
    if (other < value) value = other;
  }
  return value;
#endif
}
#endif

/// The lanes of a CUDA warp. Warp code is written once, as steps that all lanes take: `each` and
/// `ballot` call a function with the lane's number, and values of a lane live in a PerLane. All
/// threads of the warp must take part; everything between the steps is computed alike by all of
/// them.
struct CudaWarp {
  template <typename Value>
  struct PerLane {
    Value value{};
    CLEARWAY_HD Value& operator[](std::uint32_t) { return value; }
  };

  template <typename Step>
  CLEARWAY_HD static void each([[maybe_unused]] Step step) {
#ifdef __CUDA_ARCH__
    step(threadIdx.x % kWarpLanes);
    __syncwarp();
#endif
  }

  /// Synchronises the lanes before some write what others may still read outside of a step.
  CLEARWAY_HD static void sync() {
#ifdef __CUDA_ARCH__
    __syncwarp();
#endif
  }

  /// The lanes for which `test` is true, as bits.
  template <typename Test>
  CLEARWAY_HD static std::uint32_t ballot([[maybe_unused]] Test test) {
#ifdef __CUDA_ARCH__
    return __ballot_sync(0xffffffff, test(threadIdx.x % kWarpLanes));
#else
    return 0;
#endif
  }

  /// The least of the values of all lanes.
  CLEARWAY_HD static double least([[maybe_unused]] PerLane<double>& values) {
#ifdef __CUDA_ARCH__
    double value = values.value;
    for (int apart = kWarpLanes / 2; apart > 0; apart /= 2) {
      const double other = __shfl_xor_sync(0xffffffff, value, apart);
      if (other < value) value = other;
    }
    return value;
#else
    return 0;
#endif
  }

  CLEARWAY_HD static std::uint32_t least([[maybe_unused]] PerLane<std::uint32_t>& values) {
#ifdef __CUDA_ARCH__
    return least_of_lanes(values.value);
#else
    return 0;
#endif
  }

  /// Reads a value once for all lanes, because other warps may change it at any time.
  template <typename Read>
  CLEARWAY_HD static double once([[maybe_unused]] Read read) {
#ifdef __CUDA_ARCH__
    return __shfl_sync(0xffffffff, read(), 0);
#else
    return 0;
#endif
  }

  /// Replaces every lane's value with the sum of the values of the lanes before it. Returns the sum
  /// of all values.
  CLEARWAY_HD static std::uint32_t sum_before([[maybe_unused]] PerLane<std::uint32_t>& values) {
#ifdef __CUDA_ARCH__
    const std::uint32_t lane = threadIdx.x % kWarpLanes;
    std::uint32_t sum = values.value;
    for (std::uint32_t apart = 1; apart < kWarpLanes; apart *= 2) {
      const std::uint32_t other = __shfl_up_sync(0xffffffff, sum, apart);
      if (lane >= apart) sum += other;
    }
    values.value = sum - values.value;
    return __shfl_sync(0xffffffff, sum, kWarpLanes - 1);
#else
    return 0;
#endif
  }

  /// Adds n, once for the warp, to a counter that other warps also add to, unless the counter has
  /// already reached `full`, so that it cannot overflow. Returns the counter's value before.
  CLEARWAY_HD static std::uint32_t add([[maybe_unused]] std::uint32_t* counter,
                                       [[maybe_unused]] std::uint32_t n,
                                       [[maybe_unused]] std::uint32_t full) {
#ifdef __CUDA_ARCH__
    std::uint32_t before = 0;
    if (threadIdx.x % kWarpLanes == 0) {
      before = *static_cast<volatile std::uint32_t*>(counter);
      if (before < full) before = atomicAdd(counter, n);
    }
    return __shfl_sync(0xffffffff, before, 0);
#else
    return 0;
#endif
  }
};

/// The lanes of a warp as a loop, which runs warp code on the host.
struct HostWarp {
  template <typename Value>
  struct PerLane {
    Value values[kWarpLanes]{};
    Value& operator[](std::uint32_t lane) { return values[lane]; }
  };

  template <typename Step>
  static void each(Step step) {
    for (std::uint32_t lane = 0; lane < kWarpLanes; ++lane) step(lane);
  }

  static void sync() {}

  template <typename Test>
  static std::uint32_t ballot(Test test) {
    std::uint32_t bits = 0;
    for (std::uint32_t lane = 0; lane < kWarpLanes; ++lane) {
      bits |= static_cast<std::uint32_t>(static_cast<bool>(test(lane))) << lane;
    }
    return bits;
  }

  template <typename Value>
  static Value least(PerLane<Value>& values) {
    Value least = values[0];
    for (const Value value : values.values) least = value < least ? value : least;
    return least;
  }

  template <typename Read>
  static double once(Read read) {
    return read();
  }

  static std::uint32_t sum_before(PerLane<std::uint32_t>& values) {
    std::uint32_t sum = 0;
    for (std::uint32_t& value : values.values) {
      const std::uint32_t before = sum;
      sum += value;
      value = before;
    }
    return sum;
  }

  static std::uint32_t add(std::uint32_t* counter, std::uint32_t n, std::uint32_t full) {
    const std::uint32_t before = *counter;
    if (before < full) *counter += n;
    return before;
  }
};

}  // namespace clearway
