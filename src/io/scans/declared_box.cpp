#include "io/scans/declared_box.hpp"

#include <algorithm>
#include <cmath>

#include "core/messages/messages.hpp"
#include "core/util/format.hpp"

namespace clearway {

bool is_filled_in(const Box& declared) {
  for (int k = 0; k < 3; ++k) {
    const double lo = declared.lo[k], hi = declared.hi[k];
    if (!std::isfinite(lo) || !std::isfinite(hi) || lo > hi) return false;
  }
  return !(declared.lo == declared.hi);
}

std::optional<Box> reach_of(const std::optional<Box>& declared) {
  if (!declared || !is_filled_in(*declared)) return std::nullopt;
  Box reach = *declared;
  double size = 0;
  for (int k = 0; k < 3; ++k) size = std::max(size, reach.hi[k] - reach.lo[k]);
  for (int k = 0; k < 3; ++k) {
    reach.lo[k] -= size;
    reach.hi[k] += size;
  }
  return reach;
}

std::string declared_box_text(const Box& box) {
  const auto corner = [](const Vec3& p) {
    return "(" + format_digits(p.x, 9) + ", " + format_digits(p.y, 9) + ", " +
           format_digits(p.z, 9) + ")";
  };
  return corner(box.lo) + " to " + corner(box.hi);
}

void BoundsWarnings::add(const std::string& name, const Box& declared, const Found& found) {
  if (found.beyond == 0) return;
  const bool is_whole = found.beyond == found.points;
  OfKind& kind = is_whole ? wholly_ : partly_;
  if (kind.count++ > 0) return;
  kind.first = name + ": " +
               (is_whole ? "all " + counted(found.points, "point")
                         : format_count(found.beyond) + " of " + counted(found.points, "point")) +
               " lie far beyond the declared bounds, which are " + declared_box_text(declared) +
               ". The points reach from " + declared_box_text(found.box);
}

std::vector<Message> BoundsWarnings::messages() const {
  std::vector<Message> out;
  const auto more = [](const OfKind& kind) {
    return kind.count > 1 ? ". " + format_count(kind.count - 1) + " more are alike" : "";
  };
  if (partly_.count > 0) {
    out.push_back(
        warning("declared-bounds",
                partly_.first + more(partly_) +
                    ". Some records may be damaged or zero: copy or export the scan again",
                {{"count", partly_.count}}));
  }
  if (wholly_.count > 0) {
    out.push_back(warning("outside-bounds",
                          wholly_.first + more(wholly_) +
                              ". The bounds may be those of another scan or in another unit",
                          {{"count", wholly_.count}}));
  }
  return out;
}

}  // namespace clearway
