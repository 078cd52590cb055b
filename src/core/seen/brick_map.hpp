#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/seen/beam_walk.hpp"
#include "core/seen/cubes.hpp"

namespace clearway {

/// Bricks that hold cubes which are still to be seen: a hash table from a brick's indices to eight
/// words, in which a set bit is a cube that no beam has seen yet. Beams clear bits from several
/// threads at once; no result depends on their order.
class BrickMap {
 public:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  /// bricks: distinct. words: eight words for each brick.
  BrickMap(const CubeLattice& lattice, std::vector<Brick> bricks, std::vector<std::uint64_t> words)
      : lattice_(lattice), bricks_(std::move(bricks)), words_(std::move(words)) {
    std::size_t slots = 16;
    while (slots < 2 * bricks_.size()) slots *= 2;
    slots_.assign(slots, kNone);
    for (std::uint32_t b = 0; b < bricks_.size(); ++b) insert(b);
    for (int k = 0; k < 3; ++k) brick_side_[k] = kBrickCubes * lattice.side[k];
  }

  std::span<const Brick> bricks() const { return bricks_; }
  /// The eight words of a brick. Not to be called while beams clear bits.
  std::span<const std::uint64_t> words(std::uint32_t brick) const {
    return std::span(words_).subspan(std::size_t{kBrickWords} * brick, kBrickWords);
  }

  /// Index of a brick; kNone where it is none of bricks().
  std::uint32_t find(const Brick& brick) const {
    for (std::size_t slot = hash_of(brick);; ++slot) {
      const std::uint32_t found = slots_[slot & (slots_.size() - 1)];
      if (found == kNone || bricks_[found] == brick) return found;
    }
  }

  /// Clears the bits of all cubes that the beam sees. Thread safe.
  void see(const Beam& beam) {
    if (bricks_.empty()) return;
    const BeamWalk walk(beam);
    const BeamPart part = walk.clipped({0, 1}, range_, brick_side_);
    if (part.empty()) return;
    walk.walk(part, range_, brick_side_, [&](const std::int32_t* cell, double from, double to) {
      const std::uint32_t brick = find({{cell[0], cell[1], cell[2]}});
      if (brick != kNone) see_in(brick, beam, walk, {from, to});
      return true;
    });
  }

  std::uint64_t allocated_bytes() const {
    return bricks_.capacity() * sizeof(Brick) + words_.capacity() * sizeof(words_[0]) +
           slots_.capacity() * sizeof(slots_[0]);
  }
  /// Bytes of memory for this many bricks.
  static std::uint64_t bytes_for(std::uint64_t bricks) {
    return bricks *
               (sizeof(Brick) + kBrickWords * sizeof(std::uint64_t) + 4 * sizeof(std::uint32_t)) +
           64;
  }

 private:
  void insert(std::uint32_t brick) {
    std::size_t slot = hash_of(bricks_[brick]);
    while (slots_[slot & (slots_.size() - 1)] != kNone) ++slot;
    slots_[slot & (slots_.size() - 1)] = brick;
    for (int k = 0; k < 3; ++k) {
      range_.lo[k] = brick == 0 ? bricks_[0].i[k] : std::min(range_.lo[k], bricks_[brick].i[k]);
      range_.hi[k] = brick == 0 ? bricks_[0].i[k] : std::max(range_.hi[k], bricks_[brick].i[k]);
    }
  }

  std::uint64_t word_now(std::size_t word) {
    return std::atomic_ref(words_[word]).load(std::memory_order_relaxed);
  }

  void see_in(std::uint32_t brick, const Beam& beam, const BeamWalk& walk, const BeamPart& part) {
    const std::size_t first = std::size_t{kBrickWords} * brick;
    std::uint64_t open = 0;
    for (std::size_t w = 0; w < kBrickWords; ++w) open |= word_now(first + w);
    if (open == 0) return;
    CellRange cubes{};
    for (int k = 0; k < 3; ++k) {
      cubes.lo[k] = bricks_[brick].i[k] * kBrickCubes;
      cubes.hi[k] = cubes.lo[k] + kBrickCubes - 1;
    }
    walk.walk(part, cubes, lattice_.side, [&](const std::int32_t* cell, double, double) {
      const Cube cube{{cell[0], cell[1], cell[2]}};
      const std::uint32_t entry = entry_of(cube);
      const std::size_t word = first + entry / 64;
      const std::uint64_t bit = std::uint64_t{1} << (entry % 64);
      if ((word_now(word) & bit) != 0 && sees(lattice_, beam, cube)) {
        std::atomic_ref(words_[word]).fetch_and(~bit, std::memory_order_relaxed);
      }
      return true;
    });
  }

  CubeLattice lattice_;
  std::int64_t brick_side_[3];
  std::vector<Brick> bricks_;
  std::vector<std::uint64_t> words_;
  std::vector<std::uint32_t> slots_;
  CellRange range_{};
};

}  // namespace clearway
