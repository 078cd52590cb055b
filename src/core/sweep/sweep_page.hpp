#pragma once

#include <cstdint>

#include "core/page/page.hpp"
#include "core/query/search_result.hpp"
#include "core/sweep/sweep_ref.hpp"

namespace clearway {

/// Work that is still to be done for a page: runs of poses that may touch a half block (entries),
/// runs that may touch a point (walks), and single poses that may touch a point (items). All lists
/// are bounded. A block whose runs find no room is listed once as a whole, for which there is
/// always room; walks and items that find no room are done at once.
struct SweepWork {
  /// Points of a half block to be tested at nodes first_node .. first_node + node_count - 1 of the
  /// list, or at all planned nodes of its cell (kWhole).
  struct Entry {
    std::uint32_t half;  ///< number of the half block within the page: 32 points
    std::uint32_t first_node, node_count;
  };
  struct Item {
    std::uint32_t point;  ///< slot within the page: 64 for each block
    std::uint32_t node;
  };
  struct Counts {
    /// Places asked for, which may exceed the capacities
    std::uint32_t nodes, entries, walks, items;
    std::uint32_t whole;  ///< number of entries with kWhole
    std::uint32_t taken;  ///< number of entries, whole ones included, that were taken
  };
  static constexpr std::uint32_t kNone = 0xffffffff;  ///< half or point of an unused place
  /// Value of node_count of an entry that stands for all nodes of its cell
  static constexpr std::uint32_t kWhole = 0xffffffff;
  static constexpr std::uint32_t kHalves = 2;  ///< halves of a block

  std::uint32_t* nodes;
  Entry* entries;  ///< entry_capacity entries, then two for each block
  Item* walks;
  Item* items;
  Counts* counts;
  std::uint32_t node_capacity, entry_capacity, walk_capacity, item_capacity;

  /// Room for `count` places of a list, reserved by a warp.
  struct Room {
    std::uint32_t first, count, capacity;
    CLEARWAY_HD bool fits() const { return first < capacity && count <= capacity - first; }
    /// How many of the places lie within the list and must be written: all if they fit; otherwise
    /// those before its end, which the caller marks as unused.
    CLEARWAY_HD std::uint32_t written() const {
      return fits() ? count : first < capacity ? capacity - first : 0;
    }
  };
  template <typename Warp>
  CLEARWAY_HD static Room room(std::uint32_t* counter, std::uint32_t count,
                               std::uint32_t capacity) {
    return {Warp::add(counter, count, capacity), count, capacity};
  }

  /// Number of entries to be looked at; those with kWhole come after the others.
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

/// First pose of a point that is touched at no pose
inline constexpr std::uint32_t kSweepNever = 0xffffffff;

/// A page under search: the query, the points, and where answers and open work go, cell after cell
/// of the page. A pointer is null if its values are not asked for.
template <typename Element>
struct SweepPageOf {
  SweepRefOf<Element> sweep;
  PageRef page;
  Quantisation quantisation;
  std::uint64_t* hits;         ///< one word for each block, a bit for each point
  std::uint32_t* first_poses;  ///< 64 for each block
  Clearance* clearances;       ///< 64 for each block
  SweepWork work;

  static constexpr std::uint32_t kNever = kSweepNever;

  CLEARWAY_HD std::uint32_t block_count() const {
    return page.shape.cells * page.shape.blocks_per_cell;
  }
  CLEARWAY_HD const PageCell& cell_of_block(std::uint32_t block) const {
    return page.cell(block / page.shape.blocks_per_cell);
  }
  /// Index, in its cell, of a block's first point.
  CLEARWAY_HD std::uint32_t first_point(std::uint32_t block) const {
    return block % page.shape.blocks_per_cell * kBlockPoints;
  }
  /// The points of a block that are to be searched, as bits.
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
