#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "clearway/pose.hpp"
#include "core/geometry/box.hpp"
#include "core/util/progress.hpp"

namespace clearway {

/// More poses than this are not put between those given.
inline constexpr std::uint64_t kMostAddedPoses = 10'000'000;

/// All poses given, in order and unchanged, and between two of them, where a point of the box
/// `model` moves by more than `max_motion` metres (motion_bound), as few as keep every step below
/// that: evenly spaced, by motion, on the PoseSpline through the poses. Throws UsageError where
/// that takes about `most_added` poses or more, or where max_motion is below what rounding alone
/// moves; InputError for a motion that is not finite and where poses mirror the model by turns;
/// Interrupted.
std::vector<Pose> resample_trajectory(std::span<const Pose> poses, const Box& model,
                                      double max_motion, Progress& progress,
                                      std::uint64_t most_added = kMostAddedPoses);

}  // namespace clearway
