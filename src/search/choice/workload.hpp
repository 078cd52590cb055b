#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"

namespace clearway {

/// A surface takes as long as so many points a triangle (docs/design/surfaces.md).
inline constexpr std::uint64_t kPointsOfTriangle = 10;

/// Of a model of so many points, or of a surface that they are the corners of.
constexpr std::uint64_t points_to_search(std::uint64_t points, std::uint64_t triangles) {
  return triangles > 0 ? kPointsOfTriangle * triangles : points;
}

/// What a query's cost follows from, estimated from a few poses and the boxes of the store's blocks
/// in about a millisecond. The same for the same store and query.
struct Workload {
  double model_points = 0;  ///< a triangle counts as kPointsOfTriangle
  double poses = 0;
  double radius = 0;  ///< metres, of what is searched: the radius or a distance beyond
  /// Environment points in the model's box, widened by the radius, of all poses together.
  double reached_points = 0;
};

Workload workload_of(const PackedCloud& cloud, const Query& query);

/// Of a query with bodies one for each of them, else that of the model.
std::vector<Workload> workloads_of(const PackedCloud& cloud, const Query& query);

/// The same of a model of which only the box is known: with one point at least.
Workload workload_of(const PackedCloud& cloud, const QueryParameters& query, const Box& model,
                     std::uint64_t model_points, std::span<const Pose> poses);

}  // namespace clearway
