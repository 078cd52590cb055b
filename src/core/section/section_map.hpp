#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/section/section_lattice.hpp"
#include "core/util/device_bits.hpp"

/// Which pose is the first to block each cell, and a pyramid over it that dismisses rectangles of
/// cells that are blocked early enough.
///
/// Several threads of a CPU or a GPU may share a map. First poses only fall, by an atomic minimum,
/// and nothing orders other reads and writes. That is enough: a first pose that is read is an upper
/// bound of its final value, and so is every value of an entry of the pyramid for all cells below
/// it, because an entry begins as kNotBlocked and is only ever lowered to the greatest of its 16
/// children as they were read. So a rectangle is dismissed only where the final map answers for it,
/// and any other pair of a point and a pose is computed exactly and lowers the map. No cell ends
/// later than the definition says, and since only computed places write, none ends earlier.
namespace clearway {

/// The entry of a cell that nothing blocks.
inline constexpr std::uint32_t kNotBlocked = 0xffffffff;

/// Where the levels of a map and its pyramid lie: level 0 has the cells, row by row, and an entry
/// of level i + 1 stands for 4 x 4 entries of level i. The last level has one entry.
struct SectionMapShape {
  static constexpr int kMostLevels = 17;  // of at most 2^31 columns or rows

  int levels;
  std::uint32_t columns[kMostLevels], rows[kMostLevels];
  std::uint64_t start[kMostLevels];  ///< entry at which each level begins
  std::uint64_t entries;             ///< of all levels

  SectionMapShape() = default;
  explicit SectionMapShape(const SectionLattice& lattice);
};

/// A map for look-ups and updates. Owns nothing.
struct SectionMapRef {
  const SectionMapShape* shape;
  std::uint32_t* entry;

  /// Whether every cell of the rectangle is blocked at `pose` or before. May say no for cells that
  /// other threads are blocking. Surfaces are thin, so where a cell of the rectangle is free, a
  /// corner mostly is, and four reads show it.
  CLEARWAY_HD bool is_blocked_by(const SectionRect& rect, std::uint32_t pose) const {
    if (last_corner(rect) > pose) return false;
    return (rect.column_to - rect.column_from <= 1 && rect.row_to - rect.row_from <= 1) ||
           is_blocked_inside(rect, pose);
  }

  /// The greatest first pose of the cells at the corners of a rectangle.
  CLEARWAY_HD std::uint32_t last_corner(const SectionRect& rect) const {
    const std::uint32_t* const below = at(0, 0, rect.row_from);
    const std::uint32_t* const above = at(0, 0, rect.row_to);
    return greater(
        greater(shared_value(below + rect.column_from), shared_value(below + rect.column_to)),
        greater(shared_value(above + rect.column_from), shared_value(above + rect.column_to)));
  }

  /// is_blocked_by() without the look at the corners.
  CLEARWAY_HD bool is_blocked_inside(const SectionRect& rect, std::uint32_t pose) const {
    int top = 0;
    while (((rect.column_to >> 2 * top) - (rect.column_from >> 2 * top)) > 1 ||
           ((rect.row_to >> 2 * top) - (rect.row_from >> 2 * top)) > 1) {
      ++top;
    }
    int level = top;
    std::uint32_t column = rect.column_from >> 2 * level, row = rect.row_from >> 2 * level;
    while (true) {
      if (shared_value(at(level, column, row)) > pose) {
        if (level == 0) return false;
        --level;  // to the first of its parts in the rectangle
        column = greater(4 * column, rect.column_from >> 2 * level);
        row = greater(4 * row, rect.row_from >> 2 * level);
        continue;
      }
      // To the next part of the same entry, or else to the entry after it.
      while (!step(level == top, rect, level, column, row)) {
        if (level == top) return true;
        ++level;
        column >>= 2;
        row >>= 2;
      }
    }
  }

  /// Blocks a cell at a pose.
  CLEARWAY_HD void block(std::uint32_t column, std::uint32_t row, std::uint32_t pose) const {
    std::uint32_t* const cell = at(0, column, row);
    if (shared_value(cell) <= pose) return;
    std::uint32_t before = lower_shared(cell, pose);
    // The maximum above falls only where it was the maximum of this entry.
    for (int level = 1; level < shape->levels && before > pose; ++level) {
      column >>= 2;
      row >>= 2;
      std::uint32_t* const above = at(level, column, row);
      if (shared_value(above) > before) return;
      pose = greatest_below(level, column, row);
      before = lower_shared(above, pose);
    }
  }

  /// Blocks all cells of a rectangle at a pose.
  CLEARWAY_HD void block(const SectionRect& rect, std::uint32_t pose) const {
    for (std::uint32_t row = rect.row_from; row <= rect.row_to; ++row) {
      std::uint32_t* const of_row = entry + std::uint64_t{row} * shape->columns[0];
      for (std::uint32_t column = rect.column_from; column <= rect.column_to; ++column) {
        if (shared_value(of_row + column) > pose) lower_shared(of_row + column, pose);
      }
    }
    SectionRect above = rect;
    for (int level = 1; level < shape->levels; ++level) {
      above = {above.column_from >> 2, above.column_to >> 2, above.row_from >> 2,
               above.row_to >> 2};
      bool falls = false;
      for (std::uint32_t row = above.row_from; row <= above.row_to; ++row) {
        for (std::uint32_t column = above.column_from; column <= above.column_to; ++column) {
          std::uint32_t* const at =
              entry + shape->start[level] + std::uint64_t{row} * shape->columns[level] + column;
          if (shared_value(at) <= pose) continue;
          const std::uint32_t greatest = greatest_below(level, column, row);
          falls = lower_shared(at, greatest) > greatest || falls;
        }
      }
      if (!falls) return;
    }
  }

 private:
  CLEARWAY_HD std::uint32_t* at(int level, std::uint32_t column, std::uint32_t row) const {
    return entry + shape->start[level] + std::uint64_t{row} * shape->columns[level] + column;
  }

  /// Goes on, row by row, to the next entry of the rectangle on a level: to one below the same
  /// entry, or with `any` to any. False where there is none.
  CLEARWAY_HD static bool step(bool any, const SectionRect& rect, int level, std::uint32_t& column,
                               std::uint32_t& row) {
    const std::uint32_t last_column = rect.column_to >> 2 * level,
                        last_row = rect.row_to >> 2 * level;
    if (column < last_column && (any || (column & 3) != 3)) {
      ++column;
      return true;
    }
    if (row == last_row || (!any && (row & 3) == 3)) return false;
    const std::uint32_t first_column = rect.column_from >> 2 * level;
    column = any ? first_column : greater(column & ~3U, first_column);
    ++row;
    return true;
  }

  /// The greatest of the entries below an entry, each as it is read.
  CLEARWAY_HD std::uint32_t greatest_below(int level, std::uint32_t column,
                                           std::uint32_t row) const {
    const std::uint32_t column_end = smaller(4 * column + 4, shape->columns[level - 1]);
    const std::uint32_t row_end = smaller(4 * row + 4, shape->rows[level - 1]);
    std::uint32_t greatest = 0;
    for (std::uint32_t r = 4 * row; r < row_end; ++r) {
      for (std::uint32_t c = 4 * column; c < column_end; ++c) {
        greatest = greater(greatest, shared_value(at(level - 1, c, r)));
      }
    }
    return greatest;
  }

  CLEARWAY_HD static std::uint32_t greater(std::uint32_t a, std::uint32_t b) {
    return a < b ? b : a;
  }
  CLEARWAY_HD static std::uint32_t smaller(std::uint32_t a, std::uint32_t b) {
    return b < a ? b : a;
  }
};

/// One map for each bin.
class SectionMaps {
 public:
  SectionMaps(const SectionLattice& lattice, std::uint64_t bins)
      : shape_(lattice), entries_(bins * shape_.entries, kNotBlocked) {}

  SectionMapRef operator[](std::uint64_t bin) {
    return {&shape_, entries_.data() + bin * shape_.entries};
  }
  const SectionMapShape& shape() const { return shape_; }
  /// The entries of all maps, one map after another.
  std::span<std::uint32_t> entries() { return entries_; }
  std::span<const std::uint32_t> entries() const { return entries_; }

  /// The first poses of a bin's cells, row by row.
  std::span<const std::uint32_t> firsts(std::uint64_t bin) const {
    return entries().subspan(bin * shape_.entries,
                             std::uint64_t{shape_.columns[0]} * shape_.rows[0]);
  }
  /// For each cell, whether it is blocked in any of the first bins.
  std::vector<bool> blocked_anywhere(std::uint64_t bins) const;

  /// Bytes that the map of one bin takes.
  static std::uint64_t bytes_of_bin(const SectionLattice& lattice) {
    return SectionMapShape(lattice).entries * sizeof(std::uint32_t);
  }

 private:
  SectionMapShape shape_;
  std::vector<std::uint32_t> entries_;
};

}  // namespace clearway
