#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "core/seen/brick_map.hpp"
#include "core/seen/cubes.hpp"
#include "support/catch.hpp"

/// Random scenes of bricks and beams, and what beams see in them by the definition alone.
namespace clearway {

/// Wide enough for products of four lengths.
using Wide = __int128;

/// Whether beam and inner cube share a point, from the definition: the segment is clipped by the
/// six planes, with parts of it as fractions.
inline bool sees_by_definition(const CubeLattice& lattice, const Beam& beam, const Cube& cube) {
  // The part from `from_n / from_d` to `to_n / to_d`, with denominators above 0.
  Wide from_n = 0, from_d = 1, to_n = 1, to_d = 1;
  for (int k = 0; k < 3; ++k) {
    const Wide lo = Wide{lattice.side[k]} * cube.i[k] + lattice.inset[k];
    const Wide hi = Wide{lattice.side[k]} * (cube.i[k] + 1) - lattice.inset[k];
    const Wide o = beam.origin[k], d = beam.way[k];
    if (d == 0) {
      if (o < lo || o > hi) return false;
      continue;
    }
    const Wide enter = d > 0 ? lo - o : o - hi, leave = d > 0 ? hi - o : o - lo;
    const Wide length = d > 0 ? d : -d;
    if (enter * from_d > from_n * length) {
      from_n = enter;
      from_d = length;
    }
    if (leave * to_d < to_n * length) {
      to_n = leave;
      to_d = length;
    }
  }
  return from_n * to_d <= to_n * from_d;
}

/// Bricks with some of their cubes, and beams around them.
struct BeamScene {
  /// most_away: quanta; how far the bricks may lie from 0.
  explicit BeamScene(unsigned seed, std::int64_t most_away = 3'000'000) : random(seed) {
    for (int k = 0; k < 3; ++k) {
      // Sides of 4 quanta have an inner cube of two, and unequal scales give unequal sides.
      lattice.side[k] = pick(0, 3) == 0 ? pick(4, 9) : pick(4, 300);
      lattice.inset[k] = lattice.side[k] / 4;
      // Also far from 0, as coordinates of a map projection are, and below it.
      corner[k] = static_cast<std::int32_t>(
          pick(0, 2) == 0 ? pick(-4, 4) : pick(-most_away, most_away) / lattice.side[k]);
    }
    for (std::int32_t x = 0; x < 3; ++x) {
      for (std::int32_t y = 0; y < 3; ++y) {
        for (std::int32_t z = 0; z < 3; ++z) {
          if (pick(0, 3) == 0) continue;
          bricks.push_back(Brick::of({{corner[0] + 8 * x, corner[1] + 8 * y, corner[2] + 8 * z}}));
          for (std::uint32_t w = 0; w < kBrickWords; ++w) {
            words.push_back(pick(0, 4) == 0 ? 0 : (std::uint64_t{random()} << 32 | random()));
          }
        }
      }
    }
  }

  std::int64_t pick(std::int64_t least, std::int64_t most) {
    return std::uniform_int_distribution<std::int64_t>(least, most)(random);
  }

  /// A beam's end: in the bricks, on borders of cubes or inner cubes, or far away.
  void end(std::int64_t* q) {
    const std::int64_t kind = pick(0, 3);
    for (int k = 0; k < 3; ++k) {
      const std::int64_t side = lattice.side[k];
      const std::int64_t cube = corner[k] + pick(-4, 28);
      if (kind == 0) q[k] = side * cube + lattice.inset[k];
      if (kind == 1) q[k] = side * cube + (pick(0, 1) == 0 ? 0 : side - lattice.inset[k]);
      if (kind == 2) q[k] = side * cube + pick(0, side);
      if (kind == 3) q[k] = side * cube + pick(-400000000, 400000000);
    }
  }

  Beam beam() {
    Beam out{};
    std::int64_t to[3];
    end(out.origin);
    end(to);
    for (int k = 0; k < 3; ++k) {
      if (pick(0, 5) == 0) to[k] = out.origin[k];  // along an axis or a plane
      out.way[k] = to[k] - out.origin[k];
    }
    if (out.way[0] == 0 && out.way[1] == 0 && out.way[2] == 0) out.way[pick(0, 2)] = 1;
    return out;
  }

  std::mt19937 random;
  CubeLattice lattice{};
  std::int32_t corner[3];
  std::vector<Brick> bricks;
  std::vector<std::uint64_t> words;
};

/// Checks which bits of the scene's words are left after the beams, and counts those cubes that
/// were seen and those that were not.
inline void check_words(const BeamScene& scene, const std::vector<Beam>& beams,
                        std::span<const std::uint64_t> words, std::uint64_t& seen,
                        std::uint64_t& unseen) {
  for (std::uint32_t b = 0; b < scene.bricks.size(); ++b) {
    for (std::uint32_t entry = 0; entry < kBrickEntries; ++entry) {
      const std::uint32_t word = kBrickWords * b + entry / 64;
      const std::uint64_t bit = std::uint64_t{1} << (entry % 64);
      const bool left = (words[word] & bit) != 0;
      if ((scene.words[word] & bit) == 0) {
        if (left) FAIL("brick " << b << ", cube " << entry << " was not asked for");
        continue;
      }
      const Cube cube = scene.bricks[b].cube(entry);
      const bool by_definition = std::ranges::any_of(
          beams, [&](const Beam& beam) { return sees_by_definition(scene.lattice, beam, cube); });
      if (left == by_definition) FAIL("brick " << b << ", cube " << entry);
      (by_definition ? seen : unseen) += 1;
    }
  }
}

}  // namespace clearway
