#pragma once

#include <cmath>
#include <cstdint>

#include "core/grid/grid_view.hpp"
#include "core/util/device_bits.hpp"
#include "core/util/macros.hpp"

/// Places in a regular grid that takes the same memory however far a cell extends. Grid cells come
/// in bricks of 4 x 4 x 4, and a brick's place is a hash of its coordinates. Bricks that share a
/// place are searched together, which costs time but never changes an answer.
namespace clearway {

/// or_into(), skipped if the bits are set already.
CLEARWAY_HD inline void or_bits(std::uint64_t& word, std::uint64_t bits) {
  if ((word & bits) != bits) or_into(&word, bits);
}

/// The grid step that x lies in. Monotone in x; |x * per_metre| must be below 2^22.
CLEARWAY_HD inline int grid_step(float x, float per_metre) {
  return static_cast<int>(floorf(x * per_metre));
}

CLEARWAY_HD inline std::uint32_t brick_hash(int x, int y, int z) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x8da6b343U;
  h ^= static_cast<std::uint32_t>(y) * 0xd8163841U;
  h ^= static_cast<std::uint32_t>(z) * 0xcb1ab31fU;
  h = (h ^ h >> 16) * 0x7feb352dU;
  return h ^ h >> 15;
}

CLEARWAY_HD inline std::uint32_t place_in_brick(int x, int y, int z) {
  return static_cast<std::uint32_t>((x & 3) | (y & 3) << 2 | (z & 3) << 4);
}

/// The bucket of a grid cell, below `bucket_count`.
CLEARWAY_HD inline std::uint32_t bucket_of(int x, int y, int z, std::uint32_t bucket_count) {
  const std::uint32_t brick = brick_hash(x >> 2, y >> 2, z >> 2) & (bucket_count / 64 - 1);
  return brick * 64 + place_in_brick(x, y, z);
}

/// Whether a point may be within `reach`, with which the points were marked, of (x, y, z) on every
/// axis.
CLEARWAY_HD inline bool is_marked(const std::uint64_t* words, std::uint32_t word_count,
                                  float per_metre, float x, float y, float z) {
  const int i = grid_step(x, per_metre), j = grid_step(y, per_metre), k = grid_step(z, per_metre);
  const std::uint64_t word = words[brick_hash(i >> 2, j >> 2, k >> 2) & (word_count - 1)];
  return (word >> place_in_brick(i, j, k) & 1) != 0;
}

/// The four bits of brick `brick` on one axis that lie in lo .. hi.
CLEARWAY_HD inline std::uint32_t bits_within(int brick, int lo, int hi) {
  std::uint32_t bits = 0;
  for (int i = 0; i < 4; ++i) bits |= (4 * brick + i >= lo && 4 * brick + i <= hi) ? 1U << i : 0U;
  return bits;
}

/// Marks every grid cell that holds a place within `reach` of the point on every axis. Rounding is
/// monotone, so no such place is left out.
CLEARWAY_HD inline void mark_around(std::uint64_t* words, std::uint32_t word_count, float per_metre,
                                    float reach, const GridPoint& p) {
  const int x0 = grid_step(p.x - reach, per_metre), x1 = grid_step(p.x + reach, per_metre);
  const int y0 = grid_step(p.y - reach, per_metre), y1 = grid_step(p.y + reach, per_metre);
  const int z0 = grid_step(p.z - reach, per_metre), z1 = grid_step(p.z + reach, per_metre);
  for (int z = z0 >> 2; z <= z1 >> 2; ++z) {
    for (int y = y0 >> 2; y <= y1 >> 2; ++y) {
      for (int x = x0 >> 2; x <= x1 >> 2; ++x) {
        const std::uint64_t row = bits_within(x, x0, x1);
        const std::uint32_t rows = bits_within(y, y0, y1), layers = bits_within(z, z0, z1);
        std::uint64_t layer = 0, bits = 0;
        for (int i = 0; i < 4; ++i) layer |= (rows >> i & 1) != 0 ? row << 4 * i : 0;
        for (int i = 0; i < 4; ++i) bits |= (layers >> i & 1) != 0 ? layer << 16 * i : 0;
        or_bits(words[brick_hash(x, y, z) & (word_count - 1)], bits);
      }
    }
  }
}

}  // namespace clearway
