#pragma once

#include <span>
#include <string>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/progress.hpp"

namespace clearway {

/// The form in which a file held rotations.
enum class RotationSource { kMatrices, kQuaternions, kAngles };

/// Warnings of poses that are hardly meant so: rotations that are missing, in another unit or turn
/// against the path; inverse poses; quaternions in another order. Silent if the path does not turn
/// enough to tell. Steps between poses are judged by core/trajectory/step_doubts.hpp, once the
/// radius is known. name: the file's name for the texts. docs/design/trajectory.md, "Doubts".
std::vector<Message> doubts_about(std::span<const Pose> poses, RotationSource source,
                                  const std::string& name);

}  // namespace clearway
