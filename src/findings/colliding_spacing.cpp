#include "findings/colliding_spacing.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace clearway {
namespace {

/// A k-d tree of places: the middle one of a run divides the rest of it, on axes in turn.
class PlaceTree {
 public:
  PlaceTree(std::span<const QuantumPoint> points, const Quantisation& quantisation)
      : points_(points.begin(), points.end()) {
    for (std::size_t k = 0; k < 3; ++k) step_[k] = std::abs(quantisation.scale[k]);
    tbb::parallel_sort(points_, [](const QuantumPoint& a, const QuantumPoint& b) {
      return std::ranges::lexicographical_compare(a.q, b.q);
    });
    const auto same = [](const QuantumPoint& a, const QuantumPoint& b) {
      return std::ranges::equal(a.q, b.q);
    };
    points_.erase(std::unique(points_.begin(), points_.end(), same), points_.end());
    build(0, points_.size(), 0);
  }

  std::size_t size() const { return points_.size(); }

  /// The squared distance to the nearest point at another place; infinity where there is none.
  double nearest_other(const QuantumPoint& point) const {
    double least = std::numeric_limits<double>::infinity();
    look(0, points_.size(), 0, point, least);
    return least;
  }

 private:
  /// Runs of so few points are searched one by one.
  static constexpr std::size_t kLeaf = 16;
  static constexpr std::size_t kParallel = 1 << 14;

  void build(std::size_t begin, std::size_t end, int axis) {
    if (end - begin <= kLeaf) return;
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return points_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(
        at(begin), at(middle), at(end),
        [axis](const QuantumPoint& a, const QuantumPoint& b) { return a.q[axis] < b.q[axis]; });
    const auto left = [&] { build(begin, middle, (axis + 1) % 3); };
    const auto right = [&] { build(middle + 1, end, (axis + 1) % 3); };
    if (end - begin > kParallel) return tbb::parallel_invoke(left, right);
    left();
    right();
  }

  void look(std::size_t begin, std::size_t end, int axis, const QuantumPoint& point,
            double& least) const {
    if (end - begin <= kLeaf) {
      for (std::size_t i = begin; i < end; ++i) compare(points_[i], point, least);
      return;
    }
    const std::size_t middle = begin + (end - begin) / 2;
    compare(points_[middle], point, least);
    const bool below = point.q[axis] < points_[middle].q[axis];
    const double away = along(points_[middle], point, axis);
    const int next = (axis + 1) % 3;
    const auto lower = [&] { look(begin, middle, next, point, least); };
    const auto upper = [&] { look(middle + 1, end, next, point, least); };
    below ? lower() : upper();
    if (away * away < least) below ? upper() : lower();
  }

  double along(const QuantumPoint& a, const QuantumPoint& b, int axis) const {
    return static_cast<double>(difference_of(a.q[axis], b.q[axis])) *
           step_[static_cast<std::size_t>(axis)];
  }

  void compare(const QuantumPoint& a, const QuantumPoint& b, double& least) const {
    if (a.q[0] == b.q[0] && a.q[1] == b.q[1] && a.q[2] == b.q[2]) return;
    const double x = along(a, b, 0), y = along(a, b, 1), z = along(a, b, 2);
    least = std::min(least, x * x + y * y + z * z);
  }

  std::vector<QuantumPoint> points_;
  std::array<double, 3> step_{};
};

}  // namespace

std::optional<double> colliding_spacing(std::span<const QuantumPoint> points,
                                        const Quantisation& quantisation, Progress& progress) {
  const PlaceTree tree(points, quantisation);
  throw_if_stopped(progress);
  if (tree.size() < kLeastPlaces) return std::nullopt;
  const std::size_t every = (points.size() + kSpacingSample - 1) / kSpacingSample;
  std::vector<double> distances((points.size() + every - 1) / every);
  const ParallelScope scope;
  const auto look = piece_of(scope, [&](std::size_t i) {
    if (progress.stop_requested()) return;
    distances[i] = std::sqrt(tree.nearest_other(points[i * every]));
  });
  scope.begin();
  tbb::parallel_for(std::size_t{0}, distances.size(), look);
  throw_if_stopped(progress);
  const auto median = distances.begin() + static_cast<std::ptrdiff_t>((distances.size() - 1) / 2);
  std::nth_element(distances.begin(), median, distances.end());
  return *median;
}

Grouping usual_grouping(bool any, std::optional<double> spacing, double metre) {
  constexpr double kUsualGap = 0.3, kPatch = 0.01;  // metres, square metres
  constexpr double kMostPoints = 10, kWhole = 1e-9;
  if (!any) return {kUsualGap / metre, static_cast<std::uint64_t>(kMostPoints)};
  if (!spacing) return {kUsualGap / metre, 1};
  const double s = *spacing * metre, points = kPatch / (s * s), whole = std::round(points);
  // What is a whole number but for roundings is taken for it.
  const double least = std::abs(points - whole) <= kWhole * points ? whole : std::ceil(points);
  return {std::max(kUsualGap / metre, 3 * *spacing),
          static_cast<std::uint64_t>(std::clamp(least, 1.0, kMostPoints))};
}

}  // namespace clearway
