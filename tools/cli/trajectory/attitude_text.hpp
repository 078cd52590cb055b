#pragma once

#include <string>

#include "clearway/pose.hpp"

namespace clearway::tool {

/// The angles, in degrees, of a model with x forward, y left and z up, in a world with y north and
/// z up.
struct PoseAngles {
  double heading;  ///< clockwise from y, 0 to 360
  double pitch;    ///< nose up
  double roll;     ///< right side down
};

PoseAngles angles_of(const Pose& pose);

/// The attitude in words: "heading 90.0 degrees (along x), nose 1.4 degrees down, right side 0.2
/// degrees up".
std::string attitude_text(const Pose& pose);

}  // namespace clearway::tool
