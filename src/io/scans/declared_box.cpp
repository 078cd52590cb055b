#include "io/scans/declared_box.hpp"

#include <algorithm>

#include "core/util/format.hpp"

namespace clearway {

bool goes_far_beyond(const Box& declared, const std::optional<Box>& found) {
  double size = 0;
  for (int k = 0; k < 3; ++k) size = std::max(size, declared.hi[k] - declared.lo[k]);
  if (!found || !(size > 0)) return false;
  for (int k = 0; k < 3; ++k) {
    if (found->lo[k] < declared.lo[k] - size || found->hi[k] > declared.hi[k] + size) return true;
  }
  return false;
}

std::string declared_box_text(const Box& box) {
  const auto corner = [](const Vec3& p) {
    return "(" + format_digits(p.x, 9) + ", " + format_digits(p.y, 9) + ", " +
           format_digits(p.z, 9) + ")";
  };
  return corner(box.lo) + " to " + corner(box.hi);
}

}  // namespace clearway
