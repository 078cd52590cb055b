#include "search/checks/facts/ground.hpp"

#include <algorithm>

namespace clearway {

std::optional<double> height_above_ground(const ScanPoints& points, const Box& body,
                                          const Pose& pose) {
  Box column = body;
  column.lo.z = points.bottom_of_scan(body, pose);
  std::optional<double> height;
  points.visit(column, pose, [&](const Vec3& p) {
    const double here = std::max(body.lo.z - p.z, 0.0);
    height = std::min(height.value_or(here), here);
    return here > 0;
  });
  return height;
}

}  // namespace clearway
