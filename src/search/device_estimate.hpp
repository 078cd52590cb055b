#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/query.hpp"
#include "clearway/search.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {

/// A triangle takes as long to search as this many points (docs/design/model.md).
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
  /// Environment points in the model's box, widened by the radius, at all poses together.
  double reached_points = 0;
  double beams = 0;  ///< beams that are followed for seen space; the same for each body
};

Workload workload_of(const PackedCloud& cloud, const Query& query);

/// One workload for each body of a query with bodies, otherwise one for its model.
std::vector<Workload> workloads_of(const PackedCloud& cloud, const Query& query);

/// The workload of a model of which only the box is known. model_points: 0 for no model.
Workload workload_of(const PackedCloud& cloud, const QueryParameters& query, const Box& model,
                     std::uint64_t model_points, std::span<const Pose> poses);

/// Estimates the wall clock of answering a query on the CPU with this many threads, and on a GPU
/// including its start and end, with engine sweep and the time to read model and poses and to write
/// a small result. work: one for the model, or one for each body. threads: at least 1. started:
/// whether the GPU was started before. Used for choosing, never for answers.
DeviceEstimate estimate_devices(std::span<const Workload> work, const QueryParameters& query,
                                int threads, bool started = false);

/// Estimates the wall clock of a search for a section as estimate_devices() does. pairs: of a point
/// and a bin that its cell may block.
DeviceEstimate estimate_section(double pairs, int threads);

/// The least number of environment points for which a GPU is started before the query is known.
/// With fewer points the CPU answers most queries before a GPU has started.
std::uint64_t surely_many_points(int threads);

}  // namespace clearway
