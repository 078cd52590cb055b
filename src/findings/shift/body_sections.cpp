#include "findings/shift/body_sections.hpp"

#include <tbb/blocked_range.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "core/geometry/point_box.hpp"
#include "core/geometry/triangle_box.hpp"
#include "io/files/parallel_loop.hpp"

namespace clearway {
namespace {

constexpr double kBeyond = std::numeric_limits<double>::infinity();
constexpr BodySections::Column kEmptyColumn{kBeyond, -kBeyond, 0};
/// A share of a cell, and a length, by which things are made larger because of roundings.
constexpr double kShareOfCell = 1e-9;
/// Into how many bands of rows the work is divided.
constexpr std::int32_t kBands = 16;

void unite(BodySections::Column& a, const BodySections::Column& b) {
  a.from = std::min(a.from, b.from);
  a.to = std::max(a.to, b.to);
  a.bins |= b.bins;
}

/// The bins that are at most `steps` away from some bins.
std::uint64_t widened(std::uint64_t bins, int steps) {
  if (bins == 0) return 0;
  for (int done = 0; done < steps;) {
    const int step = std::min(std::max(1, done), steps - done);
    bins |= bins << step | bins >> step;
    done += step;
  }
  return bins;
}

/// A convex outline in the plane of rows and columns, each corner with its place along the axis.
struct Outline {
  std::array<Vec3, 9> corners;
  int count = 0;

  void add(const Vec3& corner) { corners[static_cast<std::size_t>(count++)] = corner; }

  /// The part of the outline where sign * (coordinate k - border) is at least 0.
  Outline cut(int k, double border, double sign) const {
    Outline out;
    for (int i = 0; i < count; ++i) {
      const Vec3& a = corners[static_cast<std::size_t>(i)];
      const Vec3& b = corners[static_cast<std::size_t>(i + 1 < count ? i + 1 : 0)];
      const double at_a = sign * (a[k] - border), at_b = sign * (b[k] - border);
      if (at_a >= 0) out.add(a);
      if ((at_a >= 0) == (at_b >= 0)) continue;
      Vec3 between = a + at_a / (at_a - at_b) * (b - a);
      between[k] = border;
      out.add(between);
    }
    return out;
  }

  Outline between(int k, double from, double to) const { return cut(k, from, 1).cut(k, to, -1); }

  std::pair<double, double> extent(int k) const {
    std::pair out{kBeyond, -kBeyond};
    for (int i = 0; i < count; ++i) {
      const double at = corners[static_cast<std::size_t>(i)][k];
      out = {std::min(out.first, at), std::max(out.second, at)};
    }
    return out;
  }
};

template <typename Run>
void for_bands(std::int32_t rows, Run run) {
  for_each_parallel(kBands, [&](std::int32_t i) {
    run(static_cast<std::int32_t>(std::int64_t{rows} * i / kBands),
        static_cast<std::int32_t>(std::int64_t{rows} * (i + 1) / kBands));
  });
}

}  // namespace

BodySections::Level::Level(std::int32_t rows_of, std::int32_t columns_of)
    : rows(rows_of),
      columns(columns_of),
      cells(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns), kEmptyColumn) {}

BodySections::BodySections(const Model& model, int axis, double radius, std::size_t most_cells)
    : axis_(axis), row_axis_((axis + 1) % 3), column_axis_((axis + 2) % 3) {
  const std::vector<Triangle> triangles = triangles_of(model);
  const Box box = (triangles.empty() ? box_of(model.vertices) : box_of(triangles)).grown(radius);
  const Vec3 size = box.size();
  const double rows = size[row_axis_], columns = size[column_axis_];
  const auto most = static_cast<double>(most_cells);
  cell_ =
      std::max({radius / 4, std::sqrt(rows * columns / most), 4 * rows / most, 4 * columns / most});
  // Everything is moved by a part of a cell, so that faces of round sizes do not lie on borders.
  first_row_ = box.lo[row_axis_] - 0.31 * cell_;
  first_column_ = box.lo[column_axis_] - 0.31 * cell_;
  bin_ = size[axis_] * (1 + kShareOfCell) / kBins;
  first_bin_ = box.lo[axis_];
  Level thin(static_cast<std::int32_t>(rows / cell_) + 2,
             static_cast<std::int32_t>(columns / cell_) + 2);
  levels_.push_back(thin);
  if (triangles.empty()) {
    add_points(model, thin);
  } else {
    add_triangles(model, thin);
  }
  grow(thin, radius);
  add_levels();
}

std::int32_t BodySections::index(double along, double first, std::int32_t count) const {
  const double at = std::floor((along - first) / cell_);
  return static_cast<std::int32_t>(std::clamp(at, -1.0, static_cast<double>(count)));
}

std::uint64_t BodySections::bins_of(double from, double to) const {
  const auto bin = [&](double at) {
    return static_cast<int>(std::clamp(std::floor((at - first_bin_) / bin_), 0.0, kBins - 1.0));
  };
  const int lowest = bin(from - kShareOfCell * bin_), highest = bin(to + kShareOfCell * bin_);
  return (~std::uint64_t{0} >> (kBins - 1 - (highest - lowest))) << lowest;
}

void BodySections::add_points(const Model& model, Level& thin) const {
  for_bands(thin.rows, [&](std::int32_t begin, std::int32_t end) {
    for (const Vec3& m : model.vertices) {
      const std::int32_t row = row_of(m[row_axis_]);
      if (row < begin || row >= end) continue;
      unite(thin.at(row, column_of(m[column_axis_])),
            {m[axis_], m[axis_], bins_of(m[axis_], m[axis_])});
    }
  });
}

void BodySections::add_triangles(const Model& model, Level& thin) const {
  const auto solid_of = [&](std::uint32_t t) {
    return model.solid_of.empty() ? kNoSolid : model.solid_of[t];
  };
  // The triangles of each solid follow one another, so that it can be filled as a whole.
  std::vector<std::uint32_t> order(model.triangles.size());
  std::iota(order.begin(), order.end(), std::uint32_t{0});
  std::ranges::stable_sort(order, {}, solid_of);
  const double slack = kShareOfCell * cell_;
  for_bands(thin.rows, [&](std::int32_t begin, std::int32_t end) {
    Level inside(end - begin, thin.columns);
    std::vector<std::array<std::int32_t, 2>> met;
    std::uint32_t solid = kNoSolid;
    const auto end_solid = [&] {
      for (const auto& [row, column] : met) {
        Column& filled = inside.at(row - begin, column);
        filled.bins = bins_of(filled.from, filled.to);
        unite(thin.at(row, column), std::exchange(filled, kEmptyColumn));
      }
      met.clear();
    };
    const auto add = [&](std::int32_t row, std::int32_t column, double from, double to) {
      if (solid == kNoSolid) return unite(thin.at(row, column), {from, to, bins_of(from, to)});
      Column& filled = inside.at(row - begin, column);
      if (filled.from > filled.to) met.push_back({row, column});
      unite(filled, {from, to, 0});
    };
    for (const std::uint32_t t : order) {
      if (solid_of(t) != solid) {
        end_solid();
        solid = solid_of(t);
      }
      Outline all;
      for (const std::uint32_t corner : model.triangles[t]) {
        const Vec3& v = model.vertices[corner];
        all.add({v[row_axis_], v[column_axis_], v[axis_]});
      }
      const auto [row_from, row_to] = all.extent(0);
      const std::int32_t first_row = std::max(begin, row_of(row_from - slack));
      const std::int32_t last_row = std::min(end - 1, row_of(row_to + slack));
      for (std::int32_t row = first_row; row <= last_row; ++row) {
        const double at_row = first_row_ + row * cell_;
        const Outline strip = all.between(0, at_row - slack, at_row + cell_ + slack);
        const auto [column_from, column_to] = strip.extent(1);
        if (strip.count == 0) continue;
        const std::int32_t first_column = std::max(0, column_of(column_from - slack));
        const std::int32_t last_column = std::min(thin.columns - 1, column_of(column_to + slack));
        for (std::int32_t column = first_column; column <= last_column; ++column) {
          const double at_column = first_column_ + column * cell_;
          const Outline piece =
              first_column == last_column
                  ? strip
                  : strip.between(1, at_column - slack, at_column + cell_ + slack);
          if (piece.count == 0) continue;
          const auto [from, to] = piece.extent(2);
          add(row, column, from, to);
        }
      }
    }
    end_solid();
  });
}

/// Sets the lowest level: what is within the radius of a model that is as thin as it is.
void BodySections::grow(const Level& thin, double radius) {
  struct Offset {
    std::int32_t row, column;
    double reach;
    int steps;
  };
  std::vector<Offset> offsets;
  const auto most = static_cast<std::int32_t>(std::ceil(radius / cell_)) + 1;
  for (std::int32_t row = -most; row <= most; ++row) {
    for (std::int32_t column = -most; column <= most; ++column) {
      // The least distance of two places of cells that are so far apart
      const double x = cell_ * std::max(0, std::abs(row) - 1);
      const double y = cell_ * std::max(0, std::abs(column) - 1);
      const double rest = radius * radius * (1 + kShareOfCell) - x * x - y * y;
      if (rest < 0) continue;
      // The radius itself where it is exact, so that flat sides have exact ends
      const double reach = x == 0 && y == 0 ? radius : std::min(radius, std::sqrt(rest));
      offsets.push_back(
          {row, column, reach, static_cast<int>(std::min(64.0, std::ceil(reach / bin_)))});
    }
  }
  Level& out = levels_[0];
  for_bands(thin.rows, [&](std::int32_t begin, std::int32_t end) {
    for (std::int32_t row = begin; row < end; ++row) {
      for (std::int32_t column = 0; column < thin.columns; ++column) {
        Column& cell = out.at(row, column);
        for (const Offset& offset : offsets) {
          const std::int32_t r = row + offset.row, c = column + offset.column;
          if (r < 0 || r >= thin.rows || c < 0 || c >= thin.columns) continue;
          const Column& from = thin.at(r, c);
          if (from.bins == 0) continue;
          unite(cell, {from.from - offset.reach, from.to + offset.reach,
                       widened(from.bins, offset.steps)});
        }
      }
    }
  });
}

void BodySections::add_levels() {
  while (levels_.back().rows > 2 || levels_.back().columns > 2) {
    const Level& fine = levels_.back();
    Level coarse((fine.rows + 1) / 2, (fine.columns + 1) / 2);
    for (std::int32_t row = 0; row < fine.rows; ++row) {
      for (std::int32_t column = 0; column < fine.columns; ++column) {
        unite(coarse.at(row / 2, column / 2), fine.at(row, column));
      }
    }
    levels_.push_back(std::move(coarse));
  }
}

BodySections::Column BodySections::column(const Box& box) const {
  const double slack = kShareOfCell * cell_;
  std::int32_t row_from = row_of(box.lo[row_axis_] - slack);
  std::int32_t row_to = row_of(box.hi[row_axis_] + slack);
  std::int32_t column_from = column_of(box.lo[column_axis_] - slack);
  std::int32_t column_to = column_of(box.hi[column_axis_] + slack);
  row_from = std::max(row_from, 0);
  column_from = std::max(column_from, 0);
  row_to = std::min(row_to, levels_[0].rows - 1);
  column_to = std::min(column_to, levels_[0].columns - 1);
  Column out = kEmptyColumn;
  if (row_from > row_to || column_from > column_to) return out;
  std::size_t level = 0;
  while (row_to - row_from > 2 || column_to - column_from > 2) {
    ++level;
    row_from /= 2;
    row_to /= 2;
    column_from /= 2;
    column_to /= 2;
  }
  const Level& at = levels_[level];
  for (std::int32_t row = row_from; row <= row_to; ++row) {
    for (std::int32_t column = column_from; column <= column_to; ++column) {
      unite(out, at.at(row, column));
    }
  }
  return out;
}

}  // namespace clearway
