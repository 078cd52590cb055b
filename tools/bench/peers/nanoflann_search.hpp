#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "clearway/query.hpp"

namespace clearway::bench {

/// The search with nanoflann that the questions of a session are compared with, on one thread. The
/// program peer_nanoflann measures whole trajectories.
class NanoflannSearch {
 public:
  /// Builds the tree; `points` must outlive it.
  explicit NanoflannSearch(std::span<const Vec3> points);
  ~NanoflannSearch();

  /// For each point, whether it collides: one radiusSearch, unsorted, for every pose and model
  /// point.
  std::vector<bool> set(const Query& query) const;

  /// The least squared distance at any pose, by one search for the nearest neighbour of every pose
  /// and model point.
  double least_distance(const Query& query) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace clearway::bench
