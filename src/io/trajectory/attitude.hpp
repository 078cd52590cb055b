#pragma once

#include <span>
#include <vector>

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

}  // namespace clearway
