#pragma once

#include <span>
#include <string>

#include "clearway/error.hpp"
#include "clearway/pose.hpp"

namespace clearway {

/// The reason why numbers of a file are not a pose; its text is empty where they are one.
struct Objection {
  std::string text;
  Remedy remedy = Remedy::kNone;
};

/// Makes a pose of a matrix. numbers: 12 or 16, a row-major 3x4 or 4x4 matrix; the last row of a
/// 4x4 must be 0 0 0 1. It must be rigid within kRigidTolerance or, with allow_non_rigid,
/// invertible.
Objection pose_of_matrix(std::span<const double> numbers, bool allow_non_rigid, Pose& pose);

/// Makes a pose of a position and a quaternion x y z w, whose norm must be within 0.01 of 1; it is
/// normalised.
Objection pose_of_quaternion(std::span<const double, 3> position,
                             std::span<const double, 4> quaternion, Pose& pose);

}  // namespace clearway
