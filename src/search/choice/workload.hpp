#pragma once

#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"

namespace clearway {

/// What a query's cost follows from, estimated from a few poses and the boxes of the store's blocks
/// in about a millisecond. The same for the same store and query.
struct Workload {
  double points = 0;  ///< of the environment
  double model_points = 0;
  double poses = 0;
  double radius = 0;        ///< metres, of what is searched: the radius or a distance beyond
  double model_length = 0;  ///< metres, longest side of the model's box
  double path_length = 0;   ///< metres, from pose to pose
  double near_points = 0;   ///< environment points in the model's box and the radius, mean of poses
  double reached_points = 0;  ///< the same of all poses together
};

Workload workload_of(const PackedCloud& cloud, const Query& query);

}  // namespace clearway
