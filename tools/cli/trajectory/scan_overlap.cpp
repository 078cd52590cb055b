#include "cli/trajectory/scan_overlap.hpp"

#include <algorithm>
#include <cmath>

namespace clearway::tool {

ScanOverlap overlap_of(std::span<const Pose> poses, const Box& path, const Box& scan) {
  ScanOverlap overlap;
  double gap[3];
  for (int k = 0; k < 3; ++k) {
    gap[k] = std::max({0.0, scan.lo[k] - path.hi[k], path.lo[k] - scan.hi[k]});
  }
  overlap.distance = std::hypot(gap[0], gap[1], gap[2]);
  for (const Pose& pose : poses) {
    bool inside = true;
    for (int k = 0; k < 3; ++k) {
      inside = inside && pose.translation[k] >= scan.lo[k] && pose.translation[k] <= scan.hi[k];
    }
    overlap.inside += inside ? 1 : 0;
  }
  return overlap;
}

}  // namespace clearway::tool
