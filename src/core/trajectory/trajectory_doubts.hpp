#pragma once

#include <span>
#include <string>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/progress.hpp"

namespace clearway {

/// What a file held in the place of rotations.
enum class RotationSource { kMatrices, kQuaternions, kAngles };

/// Warnings on poses that can hardly be meant: rotations that are missing or in another unit, that
/// turn against the path, whose poses are inverse, or whose quaternions are in another order. name:
/// of the file, for the texts. Silent where the path does not turn enough to tell. Steps between
/// poses are judged by core/trajectory/step_doubts.hpp, once the radius is known.
/// docs/design/trajectory.md, "Doubts".
std::vector<Message> doubts_about(std::span<const Pose> poses, RotationSource source,
                                  const std::string& name);

}  // namespace clearway
