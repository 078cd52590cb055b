#include "search/checks/facts/model_views.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/sweep_bounds.hpp"

namespace clearway {
namespace {

constexpr std::size_t kMostColumns = 64;
/// With fewer columns along a side, a view cannot show whether the model has holes.
constexpr std::size_t kFewColumns = 6;

}  // namespace

ModelView::ModelView(const std::vector<Vec3>& model, const Box& box, int axis, double cell)
    : box_(box), axis_(axis), across_{axis == 0 ? 1 : 0, axis == 2 ? 1 : 2} {
  for (std::size_t side = 0; side < 2; ++side) {
    const double length = box.hi[across_[side]] - box.lo[across_[side]];
    const double cells = std::clamp(std::floor(length / cell), 1.0, double{kMostColumns});
    count_[side] = static_cast<std::size_t>(cells);
    per_length_[side] = length > 0 ? cells / length : 0;
  }
  cells_.assign(count_[0] * count_[1], {kInfinity, -kInfinity});
  for (const Vec3& p : model) {
    Depth& here = cells_[column(1, p[across_[1]]) * count_[0] + column(0, p[across_[0]])];
    here.nearest = std::min(here.nearest, p[axis]);
    here.farthest = std::max(here.farthest, p[axis]);
  }
}

std::size_t ModelView::column(int side, double x) const {
  const auto k = static_cast<std::size_t>(side);
  const double at = (x - box_.lo[across_[k]]) * per_length_[k];
  return std::min(static_cast<std::size_t>(std::max(at, 0.0)), count_[k] - 1);
}

bool ModelView::encloses(const Vec3& p, double distance) const {
  const Depth& here = cells_[column(1, p[across_[1]]) * count_[0] + column(0, p[across_[0]])];
  return here.nearest < p[axis_] - distance && here.farthest > p[axis_] + distance;
}

double ModelView::open_share() const {
  const auto [width, height] = count_;
  if (std::min(width, height) < kFewColumns) return 0;
  const std::size_t size = width * height;
  // For each cell, whether a cell with points lies in each of the four directions.
  std::array<std::vector<bool>, 4> seen;
  for (auto& one : seen) one.resize(size);
  const auto walk = [&](std::vector<bool>& to, std::size_t lines, std::size_t length,
                        std::size_t line_step, std::size_t step, bool backwards) {
    for (std::size_t line = 0; line < lines; ++line) {
      bool any = false;
      for (std::size_t i = 0; i < length; ++i) {
        const std::size_t at = line * line_step + (backwards ? length - 1 - i : i) * step;
        any = any || cells_[at].filled();
        to[at] = any;
      }
    }
  };
  walk(seen[0], height, width, width, 1, false);
  walk(seen[1], height, width, width, 1, true);
  walk(seen[2], width, height, 1, width, false);
  walk(seen[3], width, height, 1, width, true);
  std::size_t open = 0, full = 0;
  for (std::size_t at = 0; at < size; ++at) {
    if (cells_[at].filled()) {
      ++full;
    } else if (seen[0][at] && seen[1][at] && seen[2][at] && seen[3][at]) {
      ++open;
    }
  }
  return static_cast<double>(open) / static_cast<double>(open + full);
}

}  // namespace clearway
