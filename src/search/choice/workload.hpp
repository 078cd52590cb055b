#pragma once

#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"

namespace clearway {

/// What a query's cost follows from, estimated from a few poses and the boxes of the store's blocks
/// in about a millisecond. The same for the same store and query.
struct Workload {
  double model_points = 0;
  double poses = 0;
  double radius = 0;  ///< metres, of what is searched: the radius or a distance beyond
  /// Environment points in the model's box, widened by the radius, of all poses together.
  double reached_points = 0;
};

Workload workload_of(const PackedCloud& cloud, const Query& query);

}  // namespace clearway
