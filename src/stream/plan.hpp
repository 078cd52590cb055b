#pragma once

#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "core/page/page_engine.hpp"
#include "core/page/pose_reach.hpp"

namespace clearway {

/// The cells within reach of the trajectory, each with the motion nodes that may touch it, in the
/// order in which the trajectory first reaches them. A pure function; reads no points.
std::vector<PlannedCell> plan(const PackedCloud& cloud, const PoseReach& reach);

}  // namespace clearway
