#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/model.hpp"

namespace clearway {

/// Where along one axis a model, grown by the radius, can be at all, in columns along this axis.
/// Only ever too much, so what lies outside is surely free.
class BodySections {
 public:
  static constexpr int kBins = 64;

  /// What some columns have together.
  struct Column {
    /// The least and the greatest coordinate along the axis; from > to where there is nothing.
    double from, to;
    /// A bit for each bin of the axis, from the lowest one up, that something may reach into.
    std::uint64_t bins;
  };

  /// axis: 0, 1 or 2. most_cells: the most columns, which then are wider. Runs in the caller's
  /// arena of oneTBB.
  BodySections(const Model& model, int axis, double radius, std::size_t most_cells);

  /// The columns that hold a box, whose coordinates along the axis are not looked at.
  Column column(const Box& box) const;

  double first_bin() const { return first_bin_; }
  double bin() const { return bin_; }

 private:
  struct Level {
    std::int32_t rows, columns;
    std::vector<Column> cells;

    /// Cells without anything.
    Level(std::int32_t rows_of, std::int32_t columns_of);
    Column& at(std::int32_t row, std::int32_t column) {
      return cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                   static_cast<std::size_t>(column)];
    }
    const Column& at(std::int32_t row, std::int32_t column) const {
      return const_cast<Level&>(*this).at(row, column);
    }
  };
  void add_points(const Model& model, Level& thin) const;
  void add_triangles(const Model& model, Level& thin) const;
  void grow(const Level& thin, double radius);
  void add_levels();
  std::uint64_t bins_of(double from, double to) const;
  std::int32_t row_of(double along) const { return index(along, first_row_, levels_[0].rows); }
  std::int32_t column_of(double along) const {
    return index(along, first_column_, levels_[0].columns);
  }
  std::int32_t index(double along, double first, std::int32_t count) const;

  int axis_, row_axis_, column_axis_;
  double first_row_ = 0, first_column_ = 0, cell_ = 0, first_bin_ = 0, bin_ = 0;
  std::vector<Level> levels_;
};

}  // namespace clearway
