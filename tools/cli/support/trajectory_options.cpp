#include "cli/support/trajectory_options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "cli/support/lengths.hpp"
#include "cli/support/options.hpp"
#include "io/paths/trajectory_file.hpp"
#include "io/scans/text/table_header.hpp"

namespace clearway::tool {
namespace {

void add_format(CLI::App& command, TrajectoryOptions& options) {
  static constexpr std::array kFormats{
      TrajectoryFormat::kAuto,          TrajectoryFormat::kMatrix, TrajectoryFormat::kTum,
      TrajectoryFormat::kEuroc,         TrajectoryFormat::kCsv,    TrajectoryFormat::kPoseXyzw,
      TrajectoryFormat::kPoseWxyz,      TrajectoryFormat::kSbet,   TrajectoryFormat::kThreedtkPose,
      TrajectoryFormat::kThreedtkFrames};
  std::vector<std::string> names;
  names.reserve(kFormats.size());
  for (const TrajectoryFormat format : kFormats) names.emplace_back(name_of(format));
  command
      .add_option_function<std::string>(
          "--trajectory-format",
          [&format = options.format](const std::string& name) {
            format = *std::ranges::find_if(
                kFormats, [&name](TrajectoryFormat known) { return name == name_of(known); });
          },
          "Format of the trajectory where a guess could go wrong (default: auto)")
      ->type_name("FORMAT")
      ->check(CLI::IsMember(names));
}

std::vector<std::string> parts_of(const std::string& text) {
  std::vector<std::string_view> fields;
  split_fields(text, ',', fields);
  return {fields.begin(), fields.end()};
}

template <typename Value>
void declare(Value& what, Value value, const std::string& word) {
  if (what != Value::kDeclared && what != value) {
    throw CLI::ValidationError("--angles", word + " contradicts what stands before it");
  }
  what = value;
}

void set_angles(TrajectoryOptions& options, const std::string& text) {
  for (const std::string& word : parts_of(text)) {
    if (word == "deg") {
      declare(options.angle_unit, AngleUnit::kDegrees, word);
    } else if (word == "rad") {
      declare(options.angle_unit, AngleUnit::kRadians, word);
    } else if (word == "ned") {
      declare(options.angle_frame, AngleFrame::kNed, word);
    } else if (word == "enu") {
      declare(options.angle_frame, AngleFrame::kEnu, word);
    } else {
      throw CLI::ValidationError(
          "--angles", word + ": expected deg or rad, and ned or enu, for example deg,ned");
    }
  }
}

void add_angles(CLI::App& command, TrajectoryOptions& options) {
  command
      .add_option_function<std::string>(
          "--angles", [&options](const std::string& text) { set_angles(options, text); },
          "Roll, pitch and yaw of the trajectory: deg or rad, and ned (heading clockwise from "
          "north) or enu (yaw counter-clockwise from east), for example deg,ned")
      ->type_name("NAME,...");
}

void add_map(CLI::App& command, TrajectoryOptions& options) {
  command
      .add_option("--trajectory-crs", options.crs,
                  "Projected CRS to turn latitudes and longitudes into, for example EPSG:25832 "
                  "(default: that of the environment, where the command has one)")
      ->type_name("CRS");
  command
      .add_option("--trajectory-datum", options.datum,
                  "Geographic CRS of latitudes and longitudes, for example EPSG:4937 (default: "
                  "WGS 84)")
      ->type_name("CRS");
}

void add_unit(CLI::App& command, TrajectoryOptions& options) {
  add_unit_option(command, "--trajectory-unit", options.metres_per_unit,
                  "Unit of the positions; ft is the environment's foot, ift the international and "
                  "us-ft the US survey foot (default: what a header says, otherwise that of the "
                  "environment)");
}

}  // namespace

void add_trajectory_options(CLI::App& command, TrajectoryOptions& options, LengthOptions& lengths) {
  {
    const GroupScope group(command, OptionGroup::kPath);
    add_format(command, options);
    command.add_flag("--allow-non-rigid", options.allow_non_rigid,
                     "Accept matrices that scale or shear");
    lengths.add(command, "--lever-arm", options.lever_arm,
                "Where the point that the trajectory gives, such as an antenna, lies in the "
                "model's frame, in metres");
  }
  const GroupScope group(command, OptionGroup::kUnits);
  add_angles(command, options);
  add_map(command, options);
  add_unit(command, options);
}

void add_options_of_reading(CLI::App& command, TrajectoryOptions& options) {
  {
    const GroupScope group(command, OptionGroup::kPath);
    add_format(command, options);
  }
  const GroupScope group(command, OptionGroup::kUnits);
  add_angles(command, options);
  add_map(command, options);
  add_unit(command, options);
}

}  // namespace clearway::tool
