#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "core/geometry/quantisation.hpp"
#include "core/util/macros.hpp"

/// Seen space (docs/design/seen.md): cubes of the store's integers, and which of them a beam has
/// passed through.
namespace clearway {

/// Cube i holds the quanta from side * i to side * (i + 1) - 1 on each axis. Its closed inner cube
/// leaves out `inset` quanta on each side, so that a beam whose true place differs by less than
/// that from the recorded one sees no cube that it has not entered.
struct CubeLattice {
  std::int64_t side[3];   ///< quanta, below 2^29
  std::int64_t inset[3];  ///< floor(side / 4), at least 1

  /// The cube that holds a quantum of an axis.
  CLEARWAY_HD std::int32_t cube_of(int axis, std::int64_t q) const {
    const std::int64_t down = q >= 0 ? q / side[axis] : -((side[axis] - 1 - q) / side[axis]);
    return static_cast<std::int32_t>(down);
  }

  friend bool operator==(const CubeLattice&, const CubeLattice&) = default;
};

/// A cube by its indices along the axes.
struct Cube {
  std::int32_t i[3];

  friend bool operator==(const Cube&, const Cube&) = default;
  friend bool operator<(const Cube& a, const Cube& b) {
    for (int k = 0; k < 3; ++k) {
      if (a.i[k] != b.i[k]) return a.i[k] < b.i[k];
    }
    return false;
  }
};

/// The middle of a cube, which by definition is fl(fl((side * i + side / 2) * scale) + offset).
CLEARWAY_HD inline Vec3 middle_of(const CubeLattice& lattice, const Quantisation& quantisation,
                                  const Cube& cube) {
  Vec3 out{};
  for (int k = 0; k < 3; ++k) {
    const double q = static_cast<double>(lattice.side[k] * cube.i[k]) +
                     0.5 * static_cast<double>(lattice.side[k]);
    out[k] = rounded_sum(rounded_product(q, quantisation.scale[k]), quantisation.offset[k]);
  }
  return out;
}

/// A beam from the scanner to the point that it measured, quanta of the store.
struct Beam {
  std::int64_t origin[3];
  std::int64_t way[3];  ///< point minus origin, below 2^30 on each axis, not all 0

  /// Beams of this many quanta or more along an axis are left out.
  static constexpr std::int64_t kMostQuanta = std::int64_t{1} << 30;
};

CLEARWAY_HD inline std::int64_t magnitude(std::int64_t value) { return value < 0 ? -value : value; }

/// Whether the closed segment of the beam and the closed inner cube share a point. Exact: by
/// separating axes, in doubled coordinates around the cube's middle. The tests of the three axes
/// come first, because they bound |m| by r + 2 |way|, with which no product below overflows: their
/// difference is at most 1.25 * 2^62.
CLEARWAY_HD inline bool sees(const CubeLattice& lattice, const Beam& beam, const Cube& cube) {
  std::int64_t m[3], r[3];
  for (int k = 0; k < 3; ++k) {
    const std::int64_t side = lattice.side[k];
    m[k] = 2 * beam.origin[k] - 2 * side * cube.i[k] - side;
    r[k] = side - 2 * lattice.inset[k];
    const std::int64_t end = m[k] + 2 * beam.way[k];
    const std::int64_t least = m[k] < end ? m[k] : end, greatest = m[k] < end ? end : m[k];
    if (least > r[k] || greatest < -r[k]) return false;
  }
  for (int k = 0; k < 3; ++k) {
    const int a = k, b = k == 2 ? 0 : k + 1;
    const std::int64_t across = magnitude(m[a] * beam.way[b] - m[b] * beam.way[a]);
    if (across > r[a] * magnitude(beam.way[b]) + r[b] * magnitude(beam.way[a])) return false;
  }
  return true;
}

/// A brick is 8 x 8 x 8 cubes: eight words of 64 bits, each of 4 x 4 x 4 cubes.
inline constexpr std::int32_t kBrickCubes = 8;
inline constexpr std::uint32_t kBrickEntries = 512;
inline constexpr std::uint32_t kBrickWords = 8;

/// The number of a cube in its brick: 64 times the word, plus the bit.
CLEARWAY_HD inline std::uint32_t entry_of(const Cube& cube) {
  const auto of = [&](int axis, std::uint32_t shift, std::uint32_t mask) {
    return static_cast<std::uint32_t>(cube.i[axis]) >> shift & mask;
  };
  const std::uint32_t word = of(0, 2, 1) | of(1, 2, 1) << 1 | of(2, 2, 1) << 2;
  const std::uint32_t bit = of(0, 0, 3) | of(1, 0, 3) << 2 | of(2, 0, 3) << 4;
  return word << 6 | bit;
}

/// A brick by its indices: floor(cube / 8) on each axis.
struct Brick {
  std::int32_t i[3];

  CLEARWAY_HD static Brick of(const Cube& cube) {
    return {{cube.i[0] >> 3, cube.i[1] >> 3, cube.i[2] >> 3}};
  }
  /// The cube with this number in the brick.
  CLEARWAY_HD Cube cube(std::uint32_t entry) const {
    const std::uint32_t word = entry >> 6, bit = entry & 63;
    Cube out{};
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t within = (word >> k & 1) * 4 + (bit >> (2 * k) & 3);
      out.i[k] = i[k] * kBrickCubes + static_cast<std::int32_t>(within);
    }
    return out;
  }
  CLEARWAY_HD friend bool operator==(const Brick& a, const Brick& b) {
    return a.i[0] == b.i[0] && a.i[1] == b.i[1] && a.i[2] == b.i[2];
  }
  friend bool operator<(const Brick& a, const Brick& b) {
    return Cube{{a.i[0], a.i[1], a.i[2]}} < Cube{{b.i[0], b.i[1], b.i[2]}};
  }
};

/// Mixes the indices of a brick, for hash tables.
CLEARWAY_HD inline std::uint64_t hash_of(const Brick& brick) {
  std::uint64_t h = 0;
  for (const std::int32_t i : brick.i) {
    h = (h ^ static_cast<std::uint32_t>(i)) * 0x9E3779B97F4A7C15U;
    h ^= h >> 29;
  }
  return h;
}

}  // namespace clearway
