#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"

namespace clearway {

/// A triangle takes as long to search as this many points (docs/design/surfaces.md).
inline constexpr std::uint64_t kPointsOfTriangle = 10;

/// The model points that a search takes as long for as for this model. points: the vertices.
/// triangles: 0 for a model of points.
constexpr std::uint64_t points_to_search(std::uint64_t points, std::uint64_t triangles) {
  return triangles > 0 ? kPointsOfTriangle * triangles : points;
}

/// The quantities from which the cost of a query follows. They are estimated in about a millisecond
/// from a few poses and the boxes of the store's blocks, and are always the same for the same store
/// and query.
struct Workload {
  /// A triangle counts as kPointsOfTriangle.
  double model_points = 0;
  double poses = 0;
  /// The largest distance that is searched, in metres: the radius, or that of clearances or
  /// profile.
  double radius = 0;
  /// Environment points in the model's box, widened by the radius, at all poses together.
  double reached_points = 0;
};

Workload workload_of(const PackedCloud& cloud, const Query& query);

/// One workload for each body of a query with bodies, otherwise one for its model.
std::vector<Workload> workloads_of(const PackedCloud& cloud, const Query& query);

/// The workload of a model of which only the box is known. model_points: 0 for no model.
Workload workload_of(const PackedCloud& cloud, const QueryParameters& query, const Box& model,
                     std::uint64_t model_points, std::span<const Pose> poses);

}  // namespace clearway
