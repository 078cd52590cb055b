#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "clearway/conflicts.hpp"
#include "clearway/pose.hpp"
#include "clearway/result.hpp"
#include "clearway/trajectory.hpp"
#include "core/describe/labels.hpp"
#include "report/drawn_bodies.hpp"
#include "report/page.hpp"

namespace clearway {

inline constexpr std::size_t kMostShownPoses = 20'000;

/// The indices of the poses for the page, ascending. All poses, or for each of `most` stretches of
/// the trajectory the pose that is nearest to the environment (without a profile, the first one);
/// in any case the first pose, the last one, and `named` ones.
std::vector<std::uint32_t> choose_poses(std::uint64_t poses, const Profile& profile,
                                        std::vector<std::uint32_t> named, std::size_t most);

/// Appends the columns pose.*: index, place, rotation, chainage, and where known distance, point
/// and labels.
void append_pose_columns(std::span<const std::uint32_t> shown, std::span<const Pose> poses,
                         std::span<const double> chainage, const Profile& profile,
                         const PoseLabels& labels, const PageLattice& lattice,
                         std::vector<PageColumn>& columns);

/// Appends the columns body.there (1 where the body has a pose), body.x to body.z and body.r0 to
/// body.r8. Each has the values of one body after the other, at the shown poses.
void append_body_columns(std::span<const DrawnBody> bodies, std::span<const std::uint32_t> shown,
                         const PageLattice& lattice, std::vector<PageColumn>& columns);

/// The value of pose.distance for a pose without a point within the profile's distance. Depths are
/// greater than it.
inline constexpr std::int32_t kNoDistance = -2147483647;
/// The step that an integer counts in the columns of rotations, distances, chainage, and labels.
inline constexpr double kRotationStep = 1.0 / (1 << 17), kDistanceStep = 1e-4, kChainageStep = 1e-3,
                        kLabelStep = 1e-3;

/// The value from which the column of a label counts. values: those of all poses, at least one.
double origin_on_page(const PoseLabel<double>& label, const std::vector<double>& values);

}  // namespace clearway
