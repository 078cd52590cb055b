#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "clearway/box.hpp"
#include "clearway/pose.hpp"
#include "clearway/progress.hpp"
#include "cli/trajectory/scan_overlap.hpp"
#include "core/trajectory/trajectory_summary.hpp"
#include "io/paths/trajectory_file.hpp"

namespace clearway::tool {

/// The angles, in degrees, of a model with x forward, y left and z up, in a world with y north and
/// z up.
struct PoseAngles {
  double heading;  ///< clockwise from y, 0 to 360
  double pitch;    ///< nose up
  double roll;     ///< right side down
};

PoseAngles angles_of(const Pose& pose);

/// The attitude in words: "heading 90.0 degrees (along x), nose 1.4 degrees down, right side 0.2
/// degrees up".
std::string attitude_text(const Pose& pose);

/// The least cosine between an axis and a direction at which the axis is said to point there.
inline constexpr double kClearAxis = 0.9;

/// How far the model moves from pose to pose.
struct StepMotion {
  double largest = 0;
  std::optional<std::size_t> above_radius;  ///< number of steps longer than the radius, if given
};

/// All that `clearway trajectory info` prints.
struct Description {
  TrajectoryFile file;
  TrajectorySummary summary;
  std::optional<Box> scan;
  ScanOverlap overlap;
  std::optional<StepMotion> motion;
};

/// The name of an axis: "x", "-x" and so on.
std::string axis_name(const BodyAxis& axis);

/// The remarks of one severity.
nlohmann::ordered_json remarks_json(const std::vector<Message>& remarks,
                                    Message::Severity severity);

nlohmann::ordered_json json_of(const Description& what);
/// The description in words, with one fact on each line.
std::string text_of(const Description& what);

}  // namespace clearway::tool
