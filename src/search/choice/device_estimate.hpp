#pragma once

#include <span>

#include "clearway/search.hpp"
#include "search/choice/workload.hpp"

namespace clearway {

/// Estimates the wall clock of answering a query on the CPU with this many threads, and on a GPU
/// including its start and end. work: one for the model, or one for each body. engine: the one that
/// searches on the CPU, which is not the grid; kAuto for the faster one where there is one model.
/// Used for choosing only. docs/design/pipeline.md says how its constants are measured.
DeviceEstimate estimate_devices(std::span<const Workload> work, const QueryParameters& query,
                                Engine engine, int threads);

/// The number of environment points from which on a GPU is started before the query is known. With
/// fewer points the CPU answers most queries before a GPU has started.
std::uint64_t surely_many_points(int threads);

}  // namespace clearway
