#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "clearway/query.hpp"

namespace clearway::bench {

/// The search with nanoflann that engines are compared with: one radiusSearch for every pose and
/// model point, in double, unsorted, poses in parallel, results marked in an atomic bit set.
class NanoflannSearch {
 public:
  /// Builds the tree; `points` must outlive it.
  explicit NanoflannSearch(std::span<const Vec3> points);
  ~NanoflannSearch();

  struct SearchResult {
    std::vector<std::uint64_t> words;  ///< bit i % 64 of word i / 64: point i collides
    std::uint64_t empty_searches = 0;
  };
  SearchResult run(const Query& query, int threads) const;

  /// The least squared distance at any pose, by one search for the nearest neighbour of every pose
  /// and model point.
  double least_distance(const Query& query) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace clearway::bench
