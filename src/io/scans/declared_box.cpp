#include "io/scans/declared_box.hpp"

#include <algorithm>
#include <cmath>

#include "core/util/format.hpp"

namespace clearway {

bool is_filled_in(const Box& declared) {
  for (int k = 0; k < 3; ++k) {
    const double lo = declared.lo[k], hi = declared.hi[k];
    if (!std::isfinite(lo) || !std::isfinite(hi) || lo > hi) return false;
  }
  return !(declared.lo == declared.hi);
}

bool goes_far_beyond(const Box& declared, const std::optional<Box>& found) {
  if (!found || !is_filled_in(declared)) return false;
  double size = 0;
  for (int k = 0; k < 3; ++k) size = std::max(size, declared.hi[k] - declared.lo[k]);
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
