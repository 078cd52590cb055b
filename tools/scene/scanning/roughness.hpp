#pragma once

#include <cmath>
#include <cstdint>

#include "scene/random.hpp"

namespace clearway::scene {

/// How a surface departs from its nominal shape, by two scales of value noise (random numbers at
/// the nodes of a lattice, blended trilinearly). Everything is in metres; amplitude 0 is smooth.
struct Roughness {
  double coarse_amplitude = 0;
  double coarse_size = 1;
  double fine_amplitude = 0;
  double fine_size = 0.1;

  bool none() const { return coarse_amplitude == 0 && fine_amplitude == 0; }
};

/// The value noise, in [-1, 1], at (x, y, z) with lattice spacing 1.
inline double value_noise(std::uint64_t key, double x, double y, double z) {
  const double fx = std::floor(x), fy = std::floor(y), fz = std::floor(z);
  const auto ix = static_cast<std::int64_t>(fx), iy = static_cast<std::int64_t>(fy),
             iz = static_cast<std::int64_t>(fz);
  const auto node = [&](int dx, int dy) {
    // One hash gives both nodes of an edge along z: its halves are for even and odd z.
    const auto edge = [&](std::int64_t pair) {
      return Random::mix(key ^ (static_cast<std::uint64_t>(ix + dx) * 0x8da6b343ULL) ^
                         (static_cast<std::uint64_t>(iy + dy) * 0xd8163841ULL << 16) ^
                         (static_cast<std::uint64_t>(pair) * 0xcb1ab31fULL << 32));
    };
    const std::uint64_t bits = edge(iz >> 1);
    const auto low = static_cast<double>(static_cast<std::uint32_t>(bits));
    const auto high = static_cast<double>(bits >> 32);
    if ((iz & 1) == 0) return low + (z - fz) * (high - low);
    const auto next = static_cast<double>(static_cast<std::uint32_t>(edge((iz >> 1) + 1)));
    return high + (z - fz) * (next - high);
  };
  const double x0 = node(0, 0) + (x - fx) * (node(1, 0) - node(0, 0));
  const double x1 = node(0, 1) + (x - fx) * (node(1, 1) - node(0, 1));
  return (x0 + (y - fy) * (x1 - x0)) * 0x1p-31 - 1;
}

inline double displacement(const Roughness& rough, std::uint64_t key, double x, double y,
                           double z) {
  const double c = 1 / rough.coarse_size, f = 1 / rough.fine_size;
  return rough.coarse_amplitude * value_noise(key, c * x, c * y, c * z) +
         rough.fine_amplitude * value_noise(key + 1, f * x, f * y, f * z);
}

}  // namespace clearway::scene
