#include "cli/trajectory/attitude_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/geometry/angle.hpp"

namespace clearway::tool {
namespace {

std::string tilt_text(const char* part, double up) {
  const double shown = std::abs(up);
  if (shown < 0.05) return fmt::format("{} level", part);
  return fmt::format("{} {:.1f} degrees {}", part, shown, up > 0 ? "up" : "down");
}

}  // namespace

PoseAngles angles_of(const Pose& pose) {
  const double* r = pose.rotation;
  double heading = std::atan2(r[0], r[3]) / kDegree;
  if (heading < 0) heading += 360;
  return {heading, std::asin(std::clamp(r[6], -1.0, 1.0)) / kDegree,
          std::atan2(r[7], r[8]) / kDegree};
}

std::string attitude_text(const Pose& pose) {
  const PoseAngles angles = angles_of(pose);
  static constexpr const char* kQuarters[] = {"along y", "along x", "against y", "against x"};
  const auto quarter = static_cast<std::size_t>(std::lround(angles.heading / 90)) % 4;
  return fmt::format("heading {:.1f} degrees (most {}), {}, {}", angles.heading, kQuarters[quarter],
                     tilt_text("nose", angles.pitch), tilt_text("right side", -angles.roll));
}

}  // namespace clearway::tool
