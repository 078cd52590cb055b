#include <vector>

#include "cli/support/warnings_json.hpp"
#include "cli/trajectory/attitude_text.hpp"
#include "cli/trajectory/description.hpp"
#include "core/geometry/angle.hpp"

namespace clearway::tool {
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

/// A pose's number with its time and its name, where the file has them.
ordered_json labelled_json(const TrajectoryFile& file, std::size_t pose) {
  ordered_json out = pose_json(file.poses[pose]);
  if (!file.times.empty()) out["time"] = file.times[pose];
  if (!file.names.empty()) out["name"] = file.names[pose];
  return out;
}

ordered_json axis_json(const BodyAxis& axis) {
  if (axis.cosine == 0) return nullptr;
  return {{"axis", axis_name(axis)}, {"mean_cosine", axis.cosine}};
}

ordered_json box_json(const Box& box) {
  return {{"lo", {box.lo.x, box.lo.y, box.lo.z}}, {"hi", {box.hi.x, box.hi.y, box.hi.z}}};
}

ordered_json remarks_json(const std::vector<Message>& remarks, Message::Severity severity) {
  std::vector<Message> chosen;
  for (const Message& remark : remarks) {
    if (remark.severity == severity) chosen.push_back(remark);
  }
  return warnings_json(chosen);
}

}  // namespace

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
    out["bounds"] = box_json(s.box);
  }
  out["length"] = s.length;
  if (!file.times.empty()) out["duration_seconds"] = file.times.back() - file.times.front();
  out["median_step"] = s.median_step;
  out["largest_step"] = {{"from_pose", s.largest_step_pose}, {"metres", s.largest_step}};
  out["still_steps"] = s.still_steps;
  out["largest_turn"] = {{"from_pose", s.largest_turn_pose}, {"degrees", s.largest_turn / kDegree}};
  out["total_turn_degrees"] = s.total_turn / kDegree;
  out["orthonormal_within"] = s.skew;
  out["up"] = axis_json(s.up);
  out["forward"] = axis_json(s.forward);
  if (what.scan) {
    out["environment"] = {{"bounds", box_json(*what.scan)},
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

}  // namespace clearway::tool
