#pragma once

#include <span>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/pose.hpp"
#include "clearway/trajectory.hpp"

namespace clearway {

/// A position with three angles instead of a rotation.
struct AttitudeRow {
  double position[3];       ///< x y z, or longitude, latitude and height
  double roll, pitch, yaw;  ///< yaw is a heading where it is counted from north
};

/// Sets the rotation of a model with x forward, y left and z up into x east, y north and z up.
/// frame: kNed, where yaw is a heading clockwise from north, or kEnu. north: direction of true
/// north, clockwise from the direction of y; 0 where angles are counted from y itself. All angles
/// are in radians. docs/design/trajectory.md, "Frames and angles".
void set_rotation(const AttitudeRow& row, AngleFrame frame, double north, Pose& pose);

/// The reason why numbers of a file are not a pose; its text is empty where they are one.
struct Objection {
  std::string text;
  Remedy remedy = Remedy::kNone;
};

/// Why a number of a file is no angle in radians; empty where it is one. most: the largest angle
/// either way. format: the format's name, for the message.
std::string objection_to_angle(const char* name, double value, double most, const char* format);

/// Makes a pose of a matrix. numbers: 12 or 16, a row-major 3x4 or 4x4 matrix; the last row of a
/// 4x4 must be 0 0 0 1. It must be rigid within kRigidTolerance or, with allow_non_rigid,
/// invertible.
Objection pose_of_matrix(std::span<const double> numbers, bool allow_non_rigid, Pose& pose);

/// Makes a pose of a position and a quaternion x y z w, whose norm must be within 0.01 of 1; it is
/// normalised.
Objection pose_of_quaternion(std::span<const double, 3> position,
                             std::span<const double, 4> quaternion, Pose& pose);

}  // namespace clearway
