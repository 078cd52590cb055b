#pragma once

#include <span>
#include <string>

#include "clearway/error.hpp"
#include "clearway/pose.hpp"

namespace clearway {

/// Why numbers of a file are no pose; without text where they are one.
struct Objection {
  std::string text;
  Remedy remedy = Remedy::kNone;
};

/// numbers: 12 or 16, a row-major 3x4 or 4x4 matrix. The last row of a 4x4 must be 0 0 0 1. Rigid
/// within kRigidTolerance or, with allow_non_rigid, invertible.
Objection pose_of_matrix(std::span<const double> numbers, bool allow_non_rigid, Pose& pose);

/// quaternion: x y z w, of a norm within 0.01 of 1; it is normalised.
Objection pose_of_quaternion(std::span<const double, 3> position,
                             std::span<const double, 4> quaternion, Pose& pose);

}  // namespace clearway
