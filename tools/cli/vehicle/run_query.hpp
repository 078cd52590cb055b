#pragma once

#include "clearway/store.hpp"
#include "clearway/trajectory.hpp"
#include "cli/run_options.hpp"

namespace clearway::tool {

/// Reads the query of a run: model or vehicle, and trajectory. Warnings of the inputs are logged at
/// once, and go into the report with those of the search.
Query read_query(RunOptions& options, const Store& store, PoseLabels& labels);

}  // namespace clearway::tool
