#pragma once

#include <vector>

#include "core/packed_cloud.hpp"
#include "core/page_engine.hpp"
#include "core/sweep_filter.hpp"

namespace clearway {

/// The cells within reach of the trajectory, each with the motion nodes that may touch it, in the
/// order in which the trajectory first reaches them. A pure function; reads no points.
std::vector<PlannedCell> plan(const PackedCloud& cloud, const SweepFilter& filter);

}  // namespace clearway
