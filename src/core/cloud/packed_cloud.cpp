#include "core/cloud/packed_cloud.hpp"

#include <algorithm>
#include <cmath>

namespace clearway {

double largest_coordinate(const PackedCloud& cloud) {
  if (cloud.tree().empty()) return 0;
  const Box box = position_box(cloud.quantisation(), cloud.tree()[0].box);
  double largest = 0;
  for (int k = 0; k < 3; ++k) {
    largest = std::max({largest, std::abs(box.lo[k]), std::abs(box.hi[k])});
  }
  return largest;
}

}  // namespace clearway
