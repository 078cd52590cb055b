// Any bytes as a text of poses or as JSON; the first bytes choose the options.
#include <cmath>

#include "campaign/campaign_file.hpp"
#include "clearway/alignment.hpp"
#include "clearway/line.hpp"
#include "clearway/trajectory.hpp"
#include "fuzz.hpp"
#include "io/files/json.hpp"
#include "io/models/vehicle_file.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

bool all_finite(std::span<const double> numbers) {
  return std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); });
}

void check(const std::vector<Pose>& poses) {
  for (const Pose& pose : poses) require(all_finite(pose.rotation) && all_finite(pose.translation));
}

void read_trajectory_bytes(Bytes bytes) {
  // A CRS that needs no database of PROJ, whose opening would take most of the time.
  constexpr const char* kMap = "+proj=utm +zone=32 +ellps=WGS84 +type=crs";
  constexpr const char* kGlobe = "+proj=longlat +ellps=WGS84 +type=crs";
  constexpr TrajectoryFormat kFormats[] = {
      TrajectoryFormat::kAuto,          TrajectoryFormat::kMatrix, TrajectoryFormat::kTum,
      TrajectoryFormat::kEuroc,         TrajectoryFormat::kCsv,    TrajectoryFormat::kPoseXyzw,
      TrajectoryFormat::kPoseWxyz,      TrajectoryFormat::kSbet,   TrajectoryFormat::kThreedtkPose,
      TrajectoryFormat::kThreedtkFrames};
  constexpr AngleUnit kUnits[] = {AngleUnit::kDeclared, AngleUnit::kDegrees, AngleUnit::kRadians};
  constexpr AngleFrame kFrames[] = {AngleFrame::kDeclared, AngleFrame::kNed, AngleFrame::kEnu};
  if (bytes.size() < 2) return;
  const unsigned more = bytes[1];
  TrajectoryOptions options{kFormats[bytes[0] % std::size(kFormats)], more % 2 == 1};
  options.angle_unit = kUnits[more / 2 % 3];
  options.angle_frame = kFrames[more / 6 % 3];
  if (more / 18 % 3 != 0) {
    options.crs = kMap;
    options.datum = kGlobe;
  }
  if (more / 54 % 2 != 0) options.lever_arm = {1, -2, 0.5};
  if (more / 108 % 2 != 0) options.metres_per_unit = 0.3048;
  const MemoryFile file(bytes.subspan(2));
  std::vector<Message> remarks;
  may_refuse([&] { check(read_trajectory(file.path(), options, &remarks)); });
}

/// An alignment in LandXML. Few poses, since their number alone is no finding.
void read_alignment_bytes(Bytes bytes) {
  if (bytes.empty()) return;
  const unsigned bits = bytes[0];
  AlignmentOptions options;
  options.step = 1000;
  options.order = bits % 2 == 0 ? AxisOrder::kNorthingEasting : AxisOrder::kEastingNorthing;
  options.reverse = (bits & 2) != 0;
  if (bits & 4) options.height = 7;
  if (bits & 8) options.max_gap = 1e9;
  if (bits & 16) options.rail_distance = 1.5;
  if (bits & 32) options.cant = CantLine::kLeftRail;
  if (bits & 64) options.alignment = "a";
  if (bits & 128) options.station_from = options.station_to = 1050;
  const MemoryFile file(bytes.subspan(1));
  may_refuse([&] {
    std::vector<Message> remarks;
    PoseLabels labels;
    const auto poses = read_alignment(file.path(), options, &remarks, &labels);
    require(labels.station.size() == poses.size());
    check(poses);
  });
}

/// A line in CSV or GeoJSON.
void read_line_bytes(Bytes bytes) {
  if (bytes.empty()) return;
  const unsigned bits = bytes[0];
  LineOptions options;
  options.step = 1e6;
  options.reverse = (bits & 1) != 0;
  if (bits & 2) options.height = 7;
  if (bits & 4) options.corner_radius = 3;
  if (bits & 8) options.cant = CantLine::kLeftRail;
  if (bits & 16) options.unit = FileUnit::named("us-ft");
  if (bits & 32) options.environment_unit = kMetresPerFoot;
  const MemoryFile file(bytes.subspan(1));
  may_refuse([&] {
    std::vector<Message> remarks;
    PoseLabels labels;
    const auto poses = read_line(file.path(), options, &remarks, &labels);
    require(labels.station.empty() || labels.station.size() == poses.size());
    check(poses);
  });
}

/// Checks that the JSON library takes what parse_json() takes, with the same value, and that what
/// parse_json() refuses alone is nested too deep or has a key twice.
void compare_with_library(const std::string& text) {
  using nlohmann::ordered_json;
  try {
    const ordered_json read = parse_json(text);
    require(ordered_json::accept(text) && read == ordered_json::parse(text));
  } catch (const JsonError& error) {
    require(!std::string(error.what()).starts_with("is no JSON") || !ordered_json::accept(text));
  }
}

/// The JSON files that people write: any value, which has to be what the JSON library reads, a
/// vehicle's file, or a campaign's.
void read_json_bytes(Bytes bytes) {
  if (bytes.empty()) return;
  const std::string text = text_of(bytes.subspan(1));
  if (bytes[0] % 3 == 0) return compare_with_library(text);
  const MemoryFile file(text);
  may_refuse([&] {
    if (bytes[0] % 3 == 1) {
      for (const BodyEntry& entry : read_vehicle_file(file.path(), 0.3048)) {
        require(!entry.name.empty());
      }
    } else if (text.find('/') == text.npos) {  // patterns with a slash would search folders
      const campaign::Campaign read = campaign::read_campaign(file.path());
      require(!read.radii.empty() && !read.routes.empty());
    }
  });
}

const bool kAdded = add_targets({{"alignment", read_alignment_bytes},
                                 {"json", read_json_bytes},
                                 {"line", read_line_bytes},
                                 {"trajectory", read_trajectory_bytes}});

}  // namespace
