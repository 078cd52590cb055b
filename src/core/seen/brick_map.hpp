#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/seen/beam_walk.hpp"
#include "core/seen/cubes.hpp"
#include "core/util/device_bits.hpp"

namespace clearway {

/// View of a BrickMap at its addresses, on the host or on a device. Does not own it.
struct BrickMapRef {
  /// An index that is none of a brick.
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  /// A place of the hash table.
  struct alignas(16) Slot {
    Brick brick;
    std::uint32_t index;  ///< of the brick; kNone where the place is free
  };

  CubeLattice lattice;
  std::int64_t brick_side[3];  ///< quanta
  CellRange range;             ///< of the bricks' indices
  const Slot* slots;
  std::uint64_t slot_mask;  ///< number of places, a power of two, minus 1
  std::uint64_t* words;     ///< eight words of each brick

  /// Index of a brick; kNone where the map does not have it.
  CLEARWAY_HD std::uint32_t find(const Brick& brick) const {
    for (std::uint64_t place = hash_of(brick);; ++place) {
      const Slot slot = slots[place & slot_mask];
      if (slot.index == kNone || slot.brick == brick) return slot.index;
    }
  }

  /// Clears the bits of all cubes that the beam sees. Thread safe.
  CLEARWAY_HD void see(const Beam& beam) const {
    const BeamWalk walk(beam);
    const BeamPart part = walk.clipped({0, 1}, range, brick_side);
    if (part.empty()) return;
    walk.walk(part, range, brick_side, [&](const std::int32_t* cell, double from, double to) {
      const Brick brick{{cell[0], cell[1], cell[2]}};
      const std::uint32_t index = find(brick);
      if (index != kNone)
        see_in(brick, words + std::uint64_t{kBrickWords} * index, beam, walk, {from, to});
      return true;
    });
  }

 private:
  CLEARWAY_HD void see_in(const Brick& brick, std::uint64_t* of_brick, const Beam& beam,
                          const BeamWalk& walk, const BeamPart& part) const {
    std::uint64_t open = 0;
    for (std::uint32_t w = 0; w < kBrickWords; ++w) open |= shared_word(of_brick + w);
    if (open == 0) return;
    CellRange cubes{};
    for (int k = 0; k < 3; ++k) {
      cubes.lo[k] = brick.i[k] * kBrickCubes;
      cubes.hi[k] = cubes.lo[k] + kBrickCubes - 1;
    }
    walk.walk(part, cubes, lattice.side, [&](const std::int32_t* cell, double, double) {
      const Cube cube{{cell[0], cell[1], cell[2]}};
      const std::uint32_t entry = entry_of(cube);
      std::uint64_t* const word = of_brick + entry / 64;
      const std::uint64_t bit = std::uint64_t{1} << (entry % 64);
      if ((shared_word(word) & bit) != 0 && sees(lattice, beam, cube)) clear_in(word, bit);
      return true;
    });
  }
};

/// Bricks that hold cubes which are still to be seen: a hash table from a brick's indices to eight
/// words, in which a set bit is a cube that no beam has seen yet. Beams clear bits from several
/// threads at once; no result depends on their order.
class BrickMap {
 public:
  /// bricks: distinct. words: eight words for each brick.
  BrickMap(const CubeLattice& lattice, std::vector<Brick> bricks, std::vector<std::uint64_t> words)
      : bricks_(std::move(bricks)), words_(std::move(words)) {
    std::size_t slots = 16;
    while (slots < 2 * bricks_.size()) slots *= 2;
    slots_.assign(slots, {{}, BrickMapRef::kNone});
    ref_.lattice = lattice;
    ref_.range = {{0, 0, 0}, {-1, -1, -1}};  // which no beam enters
    for (int k = 0; k < 3; ++k) ref_.brick_side[k] = kBrickCubes * lattice.side[k];
    ref_.slots = slots_.data();
    ref_.slot_mask = slots - 1;
    ref_.words = words_.data();
    for (std::uint32_t b = 0; b < bricks_.size(); ++b) insert(b);
  }
  BrickMap(const BrickMap&) = delete;
  BrickMap& operator=(const BrickMap&) = delete;

  std::span<const Brick> bricks() const { return bricks_; }
  std::span<const BrickMapRef::Slot> slots() const { return slots_; }
  /// The words of all bricks, eight of each. Not to be read while beams clear bits.
  std::span<const std::uint64_t> words() const { return words_; }
  std::span<const std::uint64_t> words(std::uint32_t brick) const {
    return words().subspan(std::size_t{kBrickWords} * brick, kBrickWords);
  }
  const BrickMapRef& ref() const { return ref_; }

  /// Clears the bits that are 0 in `words`, which belong to a copy of this map.
  void clear_as_in(std::span<const std::uint64_t> words) {
    for (std::size_t w = 0; w < words_.size(); ++w) words_[w] &= words[w];
  }

  /// Bytes of memory for this many bricks.
  static std::uint64_t bytes_for(std::uint64_t bricks) {
    return bricks * (sizeof(Brick) + kBrickWords * sizeof(std::uint64_t) +
                     4 * sizeof(BrickMapRef::Slot)) +
           16 * sizeof(BrickMapRef::Slot);
  }

 private:
  void insert(std::uint32_t index) {
    const Brick& brick = bricks_[index];
    std::uint64_t place = hash_of(brick);
    while (slots_[place & ref_.slot_mask].index != BrickMapRef::kNone) ++place;
    slots_[place & ref_.slot_mask] = {brick, index};
    CellRange& range = ref_.range;
    for (int k = 0; k < 3; ++k) {
      range.lo[k] = index == 0 ? brick.i[k] : std::min(range.lo[k], brick.i[k]);
      range.hi[k] = index == 0 ? brick.i[k] : std::max(range.hi[k], brick.i[k]);
    }
  }

  std::vector<Brick> bricks_;
  std::vector<std::uint64_t> words_;
  std::vector<BrickMapRef::Slot> slots_;
  BrickMapRef ref_{};
};

}  // namespace clearway
