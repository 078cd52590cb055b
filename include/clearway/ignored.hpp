#pragma once

#include <cstdint>
#include <vector>

namespace clearway {

/// How many points of a whole environment a query leaves out of the search.
struct IgnoredPointCounts {
  std::uint64_t points = 0;                    ///< each once
  std::vector<std::uint64_t> of_classes = {};  ///< of each ignored class; in a box or not
  std::vector<std::uint64_t> in_boxes = {};    ///< in each ignored box, whatever their class
  friend bool operator==(const IgnoredPointCounts&, const IgnoredPointCounts&) = default;
};

}  // namespace clearway
