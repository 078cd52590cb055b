#include "io/model/point_gaps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/geometry/model_tree.hpp"
#include "core/geometry/predicate.hpp"
#include "io/formats/mesh/vertex_welder.hpp"

namespace clearway {
namespace {

constexpr std::size_t kManyPoints = 64;

/// The least squared distance from `place` to one of the points at another place; infinite where
/// there is none.
double least_to_others(const Vec3& place, std::span<const Vec3> points) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3& point : points) {
    if (point != place) least = std::min(least, squared_distance(place, point));
  }
  return least;
}

/// The distance of one of the tree's points to its nearest neighbour. guess: about this distance.
double gap_of(const ModelTree& tree, const Vec3& place, double guess, std::vector<Vec3>& near) {
  bool grown = false;
  for (double reach = guess;;) {
    const std::size_t most = grown ? tree.size() : kManyPoints;
    if (!tree.within({place, place}, reach * reach, most, near) && reach * reach > 0) {
      reach /= 2;
      continue;
    }
    const double least = least_to_others(place, near);
    if (least <= reach * reach) return std::sqrt(least);
    reach *= 2;
    grown = true;
  }
}

}  // namespace

PointGaps gaps_of(std::span<const Vec3> points) {
  std::vector<Vec3> places;
  VertexWelder welder(places);
  for (const Vec3& point : points) welder.number_of(point);
  PointGaps found{.repeated = points.size() - places.size()};
  if (places.size() < 2) return found;
  const ModelTree tree(places);
  std::vector<double> gaps;
  std::vector<Vec3> near;
  double guess = tree.spacing() > 0 ? tree.spacing() : 1;
  for (const Vec3& place : places) {
    gaps.push_back(gap_of(tree, place, guess, near));
    if (gaps.back() > 0) guess = gaps.back();
  }
  found.largest = *std::max_element(gaps.begin(), gaps.end());
  std::nth_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2),
                   gaps.end());
  found.median = gaps[gaps.size() / 2];
  return found;
}

}  // namespace clearway
