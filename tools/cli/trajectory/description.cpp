#include "cli/trajectory/description.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "cli/support/program_json.hpp"
#include "core/describe/labels.hpp"
#include "core/geometry/angle.hpp"
#include "core/util/format.hpp"
#include "io/files/json.hpp"
#include "report/label_text.hpp"

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

namespace {

using nlohmann::ordered_json;

ordered_json pose_json(const Pose& pose) {
  const PoseAngles angles = angles_of(pose);
  return {{"position", pose.translation},
          {"rotation", pose.rotation},
          {"heading_degrees", angles.heading},
          {"pitch_degrees", angles.pitch},
          {"roll_degrees", angles.roll}};
}

/// Calls visit(label, value) for each label that the file gives a pose, without those that belong
/// beside a chainage, because there is none here.
template <typename Visit>
void for_each_label_of(const TrajectoryFile& file, std::size_t pose, const Visit& visit) {
  for_each_label([&](const auto& label) {
    const auto& values = label.of(file.labels);
    if (label.place != LabelPlace::kBesideChainage && !values.empty()) visit(label, values[pose]);
  });
}

/// A pose with its labels.
ordered_json labelled_json(const TrajectoryFile& file, std::size_t pose) {
  ordered_json out = pose_json(file.poses[pose]);
  for_each_label_of(file, pose,
                    [&](const auto& label, const auto& value) { out[label.key] = value; });
  return out;
}

ordered_json axis_json(const BodyAxis& axis) {
  if (axis.cosine == 0) return nullptr;
  return {{"axis", axis_name(axis)}, {"mean_cosine", axis.cosine}};
}

}  // namespace

ordered_json remarks_json(const std::vector<Message>& remarks, Message::Severity severity) {
  std::vector<Message> chosen;
  for (const Message& remark : remarks) {
    if (remark.severity == severity) chosen.push_back(remark);
  }
  return chosen;
}

std::string axis_name(const BodyAxis& axis) {
  return std::string(axis.negative ? "-" : "") + "xyz"[axis.axis];
}

ordered_json json_of(const Description& what) {
  const TrajectorySummary& s = what.summary;
  const TrajectoryFile& file = what.file;
  ordered_json out{{"format", name_of(file.format)}, {"poses", s.poses}};
  if (!file.crs.empty()) out["crs"] = file.crs;
  if (s.poses > 0) {
    out["first_pose"] = labelled_json(file, 0);
    out["last_pose"] = labelled_json(file, file.poses.size() - 1);
    out["bounds"] = s.box;
  }
  out["length"] = s.length;
  const std::vector<double>& times = file.labels.time;
  if (!times.empty()) out["duration_seconds"] = times.back() - times.front();
  out["median_step"] = s.median_step;
  out["largest_step"] = {{"from_pose", s.largest_step_pose}, {"metres", s.largest_step}};
  out["still_steps"] = s.still_steps;
  out["largest_turn"] = {{"from_pose", s.largest_turn_pose}, {"degrees", s.largest_turn / kDegree}};
  out["total_turn_degrees"] = s.total_turn / kDegree;
  out["orthonormal_within"] = s.skew;
  out["up"] = axis_json(s.up);
  out["forward"] = axis_json(s.forward);
  if (what.scan) {
    out["environment"] = {{"bounds", *what.scan},
                          {"distance", what.overlap.distance},
                          {"poses_inside", what.overlap.inside}};
  }
  if (what.motion) {
    out["largest_motion"] = what.motion->largest;
    if (what.motion->above_radius) out["steps_above_radius"] = *what.motion->above_radius;
  }
  out["notes"] = remarks_json(file.remarks, Message::Severity::kNote);
  out["warnings"] = remarks_json(file.remarks, Message::Severity::kWarning);
  return out;
}

namespace {

using Lines = std::vector<std::pair<const char*, std::string>>;

std::string pose_text(const Pose& pose) {
  return fmt::format("{:.3f} {:.3f} {:.3f}; {}", pose.translation[0], pose.translation[1],
                     pose.translation[2], attitude_text(pose));
}

std::string labelled_text(const TrajectoryFile& file, std::size_t pose) {
  std::string text = pose_text(file.poses[pose]);
  for_each_label_of(file, pose, [&](const auto& label, const auto& value) {
    text += "; " + label_text(label, value);
  });
  return text;
}

std::string axis_text(const BodyAxis& axis, const char* where) {
  if (axis.cosine < kClearAxis)
    return fmt::format("no axis of the poses' frame {} throughout", where);
  return fmt::format("{} of the poses' frame {} (mean cosine {:.3f})", axis_name(axis), where,
                     axis.cosine);
}

std::string time_text(const TrajectoryFile& file, double length) {
  const std::vector<double>& times = file.labels.time;
  if (times.empty()) return "not known";
  const double seconds = times.back() - times.front();
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
