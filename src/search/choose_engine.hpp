#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/query.hpp"
#include "clearway/search.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/util/messages.hpp"
#include "io/store/store_reader.hpp"

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
  double beams = 0;  ///< beams that are followed for seen space; the same for each body
};

Workload workload_of(const PackedCloud& cloud, const Query& query);

/// One workload for each body of a query with bodies, otherwise one for its model.
std::vector<Workload> workloads_of(const PackedCloud& cloud, const Query& query);

/// The workload of a model of which only the box is known. model_points: 0 for no model.
Workload workload_of(const PackedCloud& cloud, const QueryParameters& query, const Box& model,
                     std::uint64_t model_points, std::span<const Pose> poses);

/// Estimates the wall clock of the whole command on the CPU with each engine, in seconds, including
/// the time to read model and poses and to write a small result. Used for choosing, never for
/// answers. docs/design/choice.md says how good the estimate is, and how its constants were
/// measured. threads: at least 1.
EngineEstimate estimate_on_cpu(const Workload& work, int threads);

/// Estimates the wall clock of answering a query on the CPU with this many threads, and on a GPU
/// including its start and end. work: one for the model, or one for each body. engine: the one that
/// searches on the CPU, which is not the grid; kAuto for the faster one where there is one model.
/// started: whether the GPU was started before. Used for choosing only. docs/design/pipeline.md
/// says how its constants are measured.
DeviceEstimate estimate_devices(std::span<const Workload> work, const QueryParameters& query,
                                Engine engine, int threads, bool started = false);

/// The least number of environment points for which a GPU is started before the query is known.
/// With fewer points the CPU answers most queries before a GPU has started.
std::uint64_t surely_many_points(int threads);

/// Where options.engine is kAuto, sets it to the engine that will be faster by estimate, of those
/// that can answer the query within the memory. on_gpu: the search is on GPUs, which takes the
/// sweep. earlier: the engine of the run that is resumed, which continues with it; kAuto for none.
/// Where the estimates decided, the report gets them and the log the reason. options.threads is not
/// 0.
void choose_engine(const StoreReader& store, const Query& query, Engine earlier, bool on_gpu,
                   SearchOptions& options, SearchReport& report, const MessageLog& log);

}  // namespace clearway
