#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "clearway/pose.hpp"
#include "core/geometry/box.hpp"

namespace clearway {

/// Indices, ascending, of poses that stand for all: at a dropped pose, no point of the box `model`
/// is farther than `max_motion` metres (motion_bound) from where it is at the last kept pose before
/// it. Greedy: the first pose is kept, then each pose that the last kept one does not stand for.
std::vector<std::size_t> thin_trajectory(std::span<const Pose> poses, const Box& model,
                                         double max_motion);

}  // namespace clearway
