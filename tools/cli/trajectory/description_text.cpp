#include <fmt/format.h>

#include <utility>
#include <vector>

#include "cli/trajectory/attitude_text.hpp"
#include "cli/trajectory/description.hpp"
#include "core/geometry/angle.hpp"
#include "core/util/format.hpp"

namespace clearway::tool {
namespace {

using Lines = std::vector<std::pair<const char*, std::string>>;

std::string pose_text(const Pose& pose) {
  return fmt::format("{:.3f} {:.3f} {:.3f}; {}", pose.translation[0], pose.translation[1],
                     pose.translation[2], attitude_text(pose));
}

std::string labelled_text(const TrajectoryFile& file, std::size_t pose) {
  std::string text = pose_text(file.poses[pose]);
  if (!file.times.empty()) text += fmt::format("; time {}", file.times[pose]);
  if (!file.names.empty()) text += "; " + file.names[pose];
  return text;
}

std::string axis_text(const BodyAxis& axis, const char* where) {
  if (axis.cosine < kClearAxis)
    return fmt::format("no axis of the poses' frame {} throughout", where);
  return fmt::format("{} of the poses' frame {} (mean cosine {:.3f})", axis_name(axis), where,
                     axis.cosine);
}

std::string time_text(const TrajectoryFile& file, double length) {
  if (file.times.empty()) return "not known";
  const double seconds = file.times.back() - file.times.front();
  if (!(seconds > 0)) return fmt::format("{:.6g} s", seconds);
  return fmt::format("{:.6g} s, {:.3g} m/s on average", seconds,
                     length * file.metres_per_unit / seconds);
}

void add_path_lines(const Description& what, Lines& lines) {
  const TrajectorySummary& s = what.summary;
  const char* const unit = what.file.metres_per_unit == 1 ? "m" : "units of the CRS";
  lines.emplace_back("first pose", labelled_text(what.file, 0));
  lines.emplace_back("last pose", labelled_text(what.file, what.file.poses.size() - 1));
  lines.emplace_back(
      "bounds", fmt::format("{:.3f} {:.3f} {:.3f} to {:.3f} {:.3f} {:.3f}", s.box.lo.x, s.box.lo.y,
                            s.box.lo.z, s.box.hi.x, s.box.hi.y, s.box.hi.z));
  lines.emplace_back("length", fmt::format("{:.6g} {}", s.length, unit));
  lines.emplace_back("time", time_text(what.file, s.length));
  lines.emplace_back("steps", fmt::format("median {:.4g}, largest {:.4g} {} from pose {}; {} do "
                                          "not move",
                                          s.median_step, s.largest_step, unit, s.largest_step_pose,
                                          format_count(s.still_steps)));
  std::string turning =
      fmt::format("largest {:.4g} degrees from pose {}, {:.4g} in all", s.largest_turn / kDegree,
                  s.largest_turn_pose, s.total_turn / kDegree);
  if (s.length > 0) {
    turning += fmt::format(", {:.3g} degrees a metre",
                           s.total_turn / kDegree / (s.length * what.file.metres_per_unit));
  }
  lines.emplace_back("turning", std::move(turning));
  lines.emplace_back("up", axis_text(s.up, "points up (world z)"));
  lines.emplace_back("forward", axis_text(s.forward, "points along the motion"));
  lines.emplace_back("rotations", fmt::format("orthonormal within {:.2g}", s.skew));
}

Lines lines_of(const Description& what) {
  const TrajectorySummary& s = what.summary;
  Lines lines;
  lines.emplace_back("format", name_of(what.file.format));
  if (!what.file.crs.empty()) lines.back().second += ", turned into " + what.file.crs;
  lines.emplace_back("poses", format_count(s.poses));
  if (s.poses == 0) return lines;
  add_path_lines(what, lines);
  if (what.scan) {
    lines.emplace_back(
        "environment",
        fmt::format("{:.4g} % of the poses lie in its box; the boxes are {:.6g} m "
                    "apart",
                    100.0 * static_cast<double>(what.overlap.inside) / static_cast<double>(s.poses),
                    what.overlap.distance));
  }
  if (what.motion) {
    std::string text = fmt::format("at most {:.4g} m from pose to pose", what.motion->largest);
    if (what.motion->above_radius) {
      text += fmt::format(", {} steps above the radius", format_count(*what.motion->above_radius));
    }
    lines.emplace_back("model", std::move(text));
  }
  return lines;
}

}  // namespace

std::string text_of(const Description& what) {
  std::string text;
  for (const auto& [name, value] : lines_of(what)) text += fmt::format("{:<11}  {}\n", name, value);
  return text;
}

}  // namespace clearway::tool
