#pragma once

#include <cstddef>
#include <span>

#include "clearway/box.hpp"
#include "clearway/pose.hpp"

namespace clearway::tool {

/// How a path lies with respect to the box of a scan.
struct ScanOverlap {
  double distance = 0;     ///< metres between the box of the positions and that of the scan
  std::size_t inside = 0;  ///< number of poses in the scan's box
};

/// Relates a path to a scan. poses: at least one. path: the box of their positions.
ScanOverlap overlap_of(std::span<const Pose> poses, const Box& path, const Box& scan);

}  // namespace clearway::tool
