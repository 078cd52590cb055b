#include "bench/peers/nanoflann_search.hpp"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "bench/peers/nanoflann_tree.hpp"
#include "core/geometry/predicate.hpp"

namespace clearway::bench {
namespace {

// Renamed in version 1.5.
#if NANOFLANN_VERSION >= 0x150
using SearchParameters = nanoflann::SearchParameters;
using FoundPoint = nanoflann::ResultItem<std::uint32_t, double>;
#else
using SearchParameters = nanoflann::SearchParams;
using FoundPoint = std::pair<std::uint32_t, double>;
#endif

}  // namespace

struct NanoflannSearch::Index {
  NanoflannPoints adaptor;
  NanoflannTree tree;

  explicit Index(std::span<const Vec3> points)
      : adaptor{points},
        tree(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(kPeerLeafPoints)) {
    tree.buildIndex();
  }
};

NanoflannSearch::NanoflannSearch(std::span<const Vec3> points)
    : index_(std::make_unique<Index>(points)) {}

NanoflannSearch::~NanoflannSearch() = default;

std::vector<bool> NanoflannSearch::set(const Query& query) const {
  std::vector<bool> colliding(index_->adaptor.points.size());
  const double radius_squared = rounded_product(query.radius, query.radius);
  SearchParameters unsorted;
  unsorted.sorted = false;
  std::vector<FoundPoint> found;
  for (const Pose& pose : query.poses) {
    for (const Vec3& m : query.model.vertices) {
      const Vec3 moved = transform(pose, m);
      const double position[3] = {moved.x, moved.y, moved.z};
      index_->tree.radiusSearch(position, radius_squared, found, unsorted);
      for (const auto& [point, squared] : found) colliding[point] = true;
    }
  }
  return colliding;
}

double NanoflannSearch::least_distance(const Query& query) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Pose& pose : query.poses) {
    for (const Vec3& m : query.model.vertices) {
      const Vec3 moved = transform(pose, m);
      const double position[3] = {moved.x, moved.y, moved.z};
      std::uint32_t point = 0;
      double squared = 0;
      index_->tree.knnSearch(position, 1, &point, &squared);
      least = std::min(least, squared);
    }
  }
  return least;
}

}  // namespace clearway::bench
