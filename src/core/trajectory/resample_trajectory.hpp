#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "clearway/pose.hpp"
#include "core/geometry/box.hpp"
#include "core/util/progress.hpp"

namespace clearway {

/// Indices, ascending, of poses that stand for all: at a dropped pose, no point of the box `model`
/// is farther than `max_motion` metres (motion_bound) from where it is at the last kept pose before
/// it. Greedy: the first pose is kept, then each pose that the last kept one does not stand for.
std::vector<std::size_t> thin_trajectory(std::span<const Pose> poses, const Box& model,
                                         double max_motion);

/// Default limit of the number of poses that are added.
inline constexpr std::uint64_t kMostAddedPoses = 10'000'000;

/// Adds poses between the given ones, which stay unchanged and in order. Between two poses where a
/// point of the box `model` moves by more than `max_motion` metres (motion_bound), as few are added
/// as keep every step below that: evenly spaced, by motion, on the PoseSpline through the poses.
/// Throws UsageError if that takes about `most_added` poses or more, or if max_motion is below what
/// rounding alone moves; InputError for a motion that is not finite, and if some poses mirror the
/// model and others do not; Interrupted.
std::vector<Pose> resample_trajectory(std::span<const Pose> poses, const Box& model,
                                      double max_motion, Progress& progress,
                                      std::uint64_t most_added = kMostAddedPoses);

}  // namespace clearway
