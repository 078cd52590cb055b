#pragma once

#include <cstdint>

namespace clearway::scene {

/// Counter-based random numbers: a value depends on the seed, the stream and the counter alone, so
/// that any thread may compute any of them. The mixing is splitmix64's (Steele, Lea and Flood,
/// "Fast splittable pseudorandom number generators", 2014). Integer arithmetic and exact
/// conversions only: the same on every machine.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t stream) : key_(mix(mix(seed + kStep) ^ stream)) {}

  std::uint64_t bits(std::uint64_t counter) const { return mix(key_ + (counter + 1) * kStep); }

  /// A random number in [0, 1).
  double unit(std::uint64_t counter) const { return to_unit(bits(counter)); }

  static double to_unit(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

  /// A roughly normal random number with mean 0 and variance 1 (a sum of four uniforms), within
  /// +-3.5.
  static double to_normal(std::uint64_t bits) {
    const std::uint64_t sum =
        (bits & 0xffff) + (bits >> 16 & 0xffff) + (bits >> 32 & 0xffff) + (bits >> 48);
    return (static_cast<double>(sum) - 131070.0) * (1.7320508075688772 / 65536.0);
  }

  static std::uint64_t mix(std::uint64_t value) {
    value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9;
    value = (value ^ (value >> 27)) * 0x94d049bb133111eb;
    return value ^ (value >> 31);
  }

 private:
  static constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15;
  std::uint64_t key_;
};

/// A sequence of random numbers, for laying out a scene. Throw at most one in the arguments of a
/// call, because compilers evaluate arguments in different orders.
class Dice {
 public:
  Dice(std::uint64_t seed, std::uint64_t stream) : random_(seed, stream) {}

  double unit() { return random_.unit(counter_++); }
  double between(double low, double high) { return low + (high - low) * unit(); }
  /// A whole number from 0 to count - 1.
  int choice(int count) { return static_cast<int>(unit() * count); }
  bool chance(double probability) { return unit() < probability; }

 private:
  Random random_;
  std::uint64_t counter_ = 0;
};

}  // namespace clearway::scene
