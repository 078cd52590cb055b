#pragma once

#include <span>

#include "clearway/search.hpp"
#include "search/choice/workload.hpp"

namespace clearway {

/// Wall clock of answering on the CPU with so many threads, and on a GPU with its start and end.
/// work: of the model, or of each body. engine: that searches on the CPU, not the grid; kAuto: the
/// faster one, of a model. For choosing only.
/// docs/design/pipeline.md says how its constants are measured.
DeviceEstimate estimate_devices(std::span<const Workload> work, const QueryParameters& query,
                                Engine engine, int threads);

/// Environment points from which on a GPU is started before the query is known. With fewer the CPU
/// answers most queries before a GPU has started.
std::uint64_t surely_many_points(int threads);

}  // namespace clearway
