#include "search/checks/facts/ground.hpp"

#include <algorithm>

namespace clearway {

std::optional<double> Ground::height_of(const Box& body, const Pose& pose) const {
  Box column = body;
  column.lo.z = points_.bottom_of_scan(body, pose);
  std::optional<double> height;
  points_.visit(column, pose, [&](const Vec3& p) {
    const double here = std::max(body.lo.z - p.z, 0.0);
    height = std::min(height.value_or(here), here);
    return here > 0;
  });
  return height;
}

}  // namespace clearway
