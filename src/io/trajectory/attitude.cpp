#include "io/trajectory/attitude.hpp"

#include <algorithm>
#include <cmath>

namespace clearway {

void set_rotation(const AttitudeRow& row, AngleFrame frame, double north, Pose& pose) {
  const bool ned = frame == AngleFrame::kNed;
  // A body with y right and z down in a world of north, east and down equals one with y left and z
  // up in a world of east, north and up, with yaw pi / 2 - heading and the opposite pitch.
  const double turned = ned ? row.yaw + north : row.yaw - north;
  const double cy = ned ? std::sin(turned) : std::cos(turned);
  const double sy = ned ? std::cos(turned) : std::sin(turned);
  const double cp = std::cos(row.pitch);
  const double sp = ned ? -std::sin(row.pitch) : std::sin(row.pitch);
  const double cr = std::cos(row.roll);
  const double sr = std::sin(row.roll);
  const double rotation[9] = {cy * cp,
                              cy * sp * sr - sy * cr,
                              cy * sp * cr + sy * sr,
                              sy * cp,
                              sy * sp * sr + cy * cr,
                              sy * sp * cr - cy * sr,
                              -sp,
                              cp * sr,
                              cp * cr};
  std::copy_n(rotation, 9, pose.rotation);
}

}  // namespace clearway
