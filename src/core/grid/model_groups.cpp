#include "core/grid/model_groups.hpp"

#include <algorithm>
#include <cmath>

#include "core/cloud/packed_cloud.hpp"
#include "core/geometry/point_box.hpp"
#include "core/geometry/predicate.hpp"
#include "core/geometry/sweep_bounds.hpp"

namespace clearway {
namespace {

/// Orders the points so that each run of `unit` points is compact.
void sort_by_splits(std::span<Vec3> points, std::uint64_t unit) {
  if (points.size() <= unit) return;
  const int axis = box_of(points).longest_axis();
  const std::uint64_t left = left_count(points.size(), unit);
  std::nth_element(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(left), points.end(),
                   [axis](const Vec3& a, const Vec3& b) { return a[axis] < b[axis]; });
  sort_by_splits(points.first(left), unit);
  sort_by_splits(points.subspan(left), unit);
}

GridSphere sphere_of(std::span<const Vec3> points) {
  const Box box = box_of(points);
  const Vec3 centre{box.lo.x / 2 + box.hi.x / 2, box.lo.y / 2 + box.hi.y / 2,
                    box.lo.z / 2 + box.hi.z / 2};
  double squared = 0;
  for (const Vec3& p : points) squared = std::max(squared, squared_distance(p, centre));
  return {centre, std::sqrt(squared) * (1 + 32 * kUnitRoundoff) + 1e-150};
}

}  // namespace

ModelGroups::ModelGroups(std::span<const Vec3> model) : points_(model.begin(), model.end()) {
  if (model.empty()) return;
  constexpr std::size_t kPartPoints = std::size_t{kGroupPoints} * kPartGroups;
  const std::span<Vec3> points(points_);
  box_ = box_of(points);
  sort_by_splits(points, kPartPoints);
  for (std::size_t first = 0; first < points.size(); first += kPartPoints) {
    const auto part = points.subspan(first, std::min(kPartPoints, points.size() - first));
    parts_.push_back(sphere_of(part));
    sort_by_splits(part, kGroupPoints);
  }
  for (std::size_t first = 0; first < points.size(); first += kGroupPoints) {
    groups_.push_back(sphere_of(
        points.subspan(first, std::min<std::size_t>(kGroupPoints, points.size() - first))));
  }
}

}  // namespace clearway
