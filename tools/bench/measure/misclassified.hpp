#pragma once

#include <array>
#include <cstdint>

#include "io/result/result.hpp"

/// How wrong an answer is, given the truth: a result with clearances of a distance D beyond its
/// radius r (`run --radius r --clearance D`), so that it holds the exact distance d of every point
/// that can be expected to be decided wrongly.
namespace clearway::bench {

/// Points on which two answers differ. A wrong point's distance is |d - r|, how far it lies from
/// the decision boundary.
struct Misclassified {
  std::uint64_t environment_points = 0;  ///< number of points in the truth's environment
  std::uint64_t false_hits = 0;          ///< points found though they do not collide
  std::uint64_t misses = 0;              ///< points that collide but were not found
  std::uint64_t beyond = 0;              ///< false hits with d >= D, so a distance >= D - r
  double largest_distance = 0;           ///< metres, of the wrong points without those beyond
  /// The wrong points without those beyond, by distance: below 1e-16, from 1e-16, from 1e-15, ...
  /// from 1 m.
  std::array<std::uint64_t, 18> histogram{};

  friend bool operator==(const Misclassified&, const Misclassified&) = default;
};

/// Compares two answers by source index alone: hashes, quantisation, model, trajectory and radius
/// of `other` may differ from the truth's. Points that only `other` has, after the truth's
/// (stretch_environment), do not count. Throws InputError where D <= r, where `other` has fewer
/// environment points, and as ResultReader does.
Misclassified misclassified(const ResultReader& truth, const ResultReader& other);

/// Element i: how many points have |d - radius| <= 2^i ulps of the radius, where an ulp is the
/// distance to the next greater double.
using NearBoundary = std::array<std::uint64_t, 41>;

/// Counts the points near the decision boundary. Throws InputError unless the clearances reach 2^40
/// ulps beyond the radius, about 2.5e-4 of it.
NearBoundary points_near_boundary(const ResultReader& truth, double radius);

}  // namespace clearway::bench
