#pragma once

#include <cstddef>
#include <span>

#include "clearway/box.hpp"
#include "clearway/pose.hpp"

namespace clearway::tool {

/// Where a path is, seen from the box of a scan.
struct ScanOverlap {
  double distance = 0;     ///< between the box of the positions and that of the scan, metres
  std::size_t inside = 0;  ///< poses whose position is in the scan's box
};

/// poses: at least one.
ScanOverlap overlap_of(std::span<const Pose> poses, const Box& path, const Box& scan);

}  // namespace clearway::tool
