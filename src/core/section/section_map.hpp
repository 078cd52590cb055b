#pragma once

#include <cstdint>
#include <vector>

#include "core/section/section_lattice.hpp"
#include "core/util/device_bits.hpp"

/// Which pose is the first to block each cell, and a pyramid over it that dismisses rectangles of
/// cells that are blocked early enough.
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
  /// other threads are blocking.
  CLEARWAY_HD bool is_blocked_by(const SectionRect& rect, std::uint32_t pose) const {
    int level = 0;
    while (((rect.column_to >> 2 * level) - (rect.column_from >> 2 * level)) > 1 ||
           ((rect.row_to >> 2 * level) - (rect.row_from >> 2 * level)) > 1) {
      ++level;
    }
    return is_blocked_at(level,
                         {rect.column_from >> 2 * level, rect.column_to >> 2 * level,
                          rect.row_from >> 2 * level, rect.row_to >> 2 * level},
                         rect, pose);
  }

  /// Blocks a cell at a pose.
  CLEARWAY_HD void block(std::uint32_t column, std::uint32_t row, std::uint32_t pose) const {
    std::uint32_t* at = entry + std::uint64_t{row} * shape->columns[0] + column;
    if (shared_value(at) <= pose) return;
    std::uint32_t before = lower_shared(at, pose);
    // The maximum above falls only where it was the maximum of this entry.
    for (int level = 1; level < shape->levels && before > pose; ++level) {
      column >>= 2;
      row >>= 2;
      std::uint32_t* above =
          entry + shape->start[level] + std::uint64_t{row} * shape->columns[level] + column;
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
  /// Looks at the entries of a level, and below those that do not tell at their parts in `rect`.
  CLEARWAY_HD bool is_blocked_at(int level, const SectionRect& here, const SectionRect& rect,
                                 std::uint32_t pose) const {
    const std::uint32_t* const at = entry + shape->start[level];
    for (std::uint32_t row = here.row_from; row <= here.row_to; ++row) {
      for (std::uint32_t column = here.column_from; column <= here.column_to; ++column) {
        if (shared_value(at + std::uint64_t{row} * shape->columns[level] + column) <= pose) {
          continue;
        }
        if (level == 0) return false;
        const int below = 2 * (level - 1);
        const SectionRect parts{greater(4 * column, rect.column_from >> below),
                                smaller(4 * column + 3, rect.column_to >> below),
                                greater(4 * row, rect.row_from >> below),
                                smaller(4 * row + 3, rect.row_to >> below)};
        if (!is_blocked_at(level - 1, parts, rect, pose)) return false;
      }
    }
    return true;
  }

  /// The greatest of the entries below an entry, each as it is read.
  CLEARWAY_HD std::uint32_t greatest_below(int level, std::uint32_t column,
                                           std::uint32_t row) const {
    const std::uint32_t* const at = entry + shape->start[level - 1];
    const std::uint32_t columns = shape->columns[level - 1];
    const std::uint32_t column_end = smaller(4 * column + 4, columns);
    const std::uint32_t row_end = smaller(4 * row + 4, shape->rows[level - 1]);
    std::uint32_t greatest = 0;
    for (std::uint32_t r = 4 * row; r < row_end; ++r) {
      for (std::uint32_t c = 4 * column; c < column_end; ++c) {
        greatest = greater(greatest, shared_value(at + std::uint64_t{r} * columns + c));
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
  /// The first poses of a bin's cells, row by row.
  const std::uint32_t* firsts(std::uint64_t bin) const {
    return entries_.data() + bin * shape_.entries;
  }

  /// Bytes that the map of one bin takes.
  static std::uint64_t bytes_of_bin(const SectionLattice& lattice) {
    return SectionMapShape(lattice).entries * sizeof(std::uint32_t);
  }

 private:
  SectionMapShape shape_;
  std::vector<std::uint32_t> entries_;
};

}  // namespace clearway
