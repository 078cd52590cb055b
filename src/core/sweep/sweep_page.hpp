#pragma once

#include <cstdint>

#include "core/page/page.hpp"
#include "core/query/clearance_set.hpp"
#include "core/sweep/sweep_ref.hpp"

namespace clearway {

/// What is still to be done for a page: runs of poses that may touch a half block, runs that may
/// touch a point (walks), and single poses that may touch a point (items). All lists are bounded. A
/// block whose runs find no room is put down once as a whole, for which there is always room; walks
/// and items that find none are done at once.
struct SweepWork {
  /// Points of a half block to be put to nodes first_node .. first_node + node_count - 1 of the
  /// list, or to all planned nodes of its cell (kWhole).
  struct Entry {
    std::uint32_t half;  ///< within the page: 32 points
    std::uint32_t first_node, node_count;
  };
  struct Item {
    std::uint32_t point;  ///< slot within the page: 64 a block
    std::uint32_t node;
  };
  struct Counts {
    std::uint32_t nodes, entries, walks, items;  ///< asked for: may exceed the capacities
    std::uint32_t whole;                         ///< entries with kWhole
    std::uint32_t taken;                         ///< of entries and whole
  };
  static constexpr std::uint32_t kNone = 0xffffffff;   ///< half or point of a place not used
  static constexpr std::uint32_t kWhole = 0xffffffff;  ///< node_count
  static constexpr std::uint32_t kHalves = 2;          ///< of a block

  std::uint32_t* nodes;
  Entry* entries;  ///< entry_capacity, then two a block
  Item* walks;
  Item* items;
  Counts* counts;
  std::uint32_t node_capacity, entry_capacity, walk_capacity, item_capacity;

  /// Room for `count` places of a list, taken by a warp.
  struct Room {
    std::uint32_t first, count, capacity;
    CLEARWAY_HD bool fits() const { return first < capacity && count <= capacity - first; }
    /// Places that must be written: all, or those left, as not used.
    CLEARWAY_HD std::uint32_t written() const {
      return fits() ? count : first < capacity ? capacity - first : 0;
    }
  };
  template <typename Warp>
  CLEARWAY_HD static Room room(std::uint32_t* counter, std::uint32_t count,
                               std::uint32_t capacity) {
    return {Warp::add(counter, count, capacity), count, capacity};
  }

  /// Entries to be looked at, those with kWhole after the others.
  CLEARWAY_HD std::uint32_t entry_count() const { return listed_entries() + counts->whole; }
  CLEARWAY_HD Entry entry(std::uint32_t index) const {
    const std::uint32_t listed = listed_entries();
    return entries[index < listed ? index : entry_capacity + index - listed];
  }

  CLEARWAY_HD std::uint32_t walk_count() const {
    return counts->walks < walk_capacity ? counts->walks : walk_capacity;
  }
  CLEARWAY_HD std::uint32_t item_count() const {
    return counts->items < item_capacity ? counts->items : item_capacity;
  }

 private:
  CLEARWAY_HD std::uint32_t listed_entries() const {
    return counts->entries < entry_capacity ? counts->entries : entry_capacity;
  }
};

inline constexpr std::uint32_t kSweepNever = 0xffffffff;  ///< a first pose: there is none

/// A page under search: the query, the points, and where answers and open work go, cell after
/// cell of the page; null for what is not asked for.
template <typename Element>
struct SweepPageOf {
  SweepRefOf<Element> sweep;
  PageRef page;
  Quantisation quantisation;
  std::uint64_t* hits;         ///< a word a block
  std::uint32_t* first_poses;  ///< 64 a block
  Clearance* clearances;       ///< likewise
  SweepWork work;

  static constexpr std::uint32_t kNever = kSweepNever;

  CLEARWAY_HD std::uint32_t block_count() const {
    return page.shape.cells * page.shape.blocks_per_cell;
  }
  CLEARWAY_HD const PageCell& cell_of_block(std::uint32_t block) const {
    return page.cell(block / page.shape.blocks_per_cell);
  }
  /// Index in its cell of a block's first point.
  CLEARWAY_HD std::uint32_t first_point(std::uint32_t block) const {
    return block % page.shape.blocks_per_cell * kBlockPoints;
  }
  /// Of a block's points those to be searched, as bits.
  CLEARWAY_HD std::uint64_t searched(std::uint32_t block) const {
    const std::uint32_t per_cell = page.shape.blocks_per_cell;
    return page.searched(block / per_cell, block % per_cell);
  }
  CLEARWAY_HD bool is_searched(std::uint32_t block, std::uint32_t bit) const {
    const std::uint32_t per_cell = page.shape.blocks_per_cell;
    return page.is_searched(block / per_cell, block % per_cell * kBlockPoints + bit);
  }
  CLEARWAY_HD Vec3 point(const PageCell& cell, std::uint32_t index) const {
    return page.position(quantisation, cell, index);
  }
};

using SweepPage = SweepPageOf<Vec3>;

}  // namespace clearway
