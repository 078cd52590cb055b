#pragma once

#include <cstdint>
#include <vector>

namespace clearway {

/// How many points of a whole environment a query leaves out of the search.
struct IgnoredPointCounts {
  std::uint64_t points = 0;  ///< ignored points, each counted once
  /// Number of points of each ignored class, inside a box or not
  std::vector<std::uint64_t> of_classes = {};
  /// Number of points in each ignored box, whatever their class
  std::vector<std::uint64_t> in_boxes = {};
  friend bool operator==(const IgnoredPointCounts&, const IgnoredPointCounts&) = default;
};

}  // namespace clearway
