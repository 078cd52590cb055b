#include "cli/support/trajectory_options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "io/trajectory/trajectory_file.hpp"

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

void set_angles(TrajectoryOptions& options, const std::vector<std::string>& words) {
  const auto declare = [](auto& what, auto value, const std::string& word) {
    if (what != decltype(value)::kDeclared && what != value) {
      throw CLI::ValidationError("--angles", word + " contradicts what stands before it");
    }
    what = value;
  };
  for (const std::string& word : words) {
    if (word == "deg") declare(options.angle_unit, AngleUnit::kDegrees, word);
    if (word == "rad") declare(options.angle_unit, AngleUnit::kRadians, word);
    if (word == "ned") declare(options.angle_frame, AngleFrame::kNed, word);
    if (word == "enu") declare(options.angle_frame, AngleFrame::kEnu, word);
  }
}

void add_angles(CLI::App& command, TrajectoryOptions& options) {
  command
      .add_option_function<std::vector<std::string>>(
          "--angles",
          [&options](const std::vector<std::string>& words) { set_angles(options, words); },
          "Roll, pitch and yaw of the trajectory: deg or rad, and ned (heading clockwise from "
          "north) or enu (yaw counter-clockwise from east), for example deg,ned")
      ->delimiter(',')
      ->expected(1)
      ->type_name("NAME,...")
      ->check(CLI::IsMember({"deg", "rad", "ned", "enu"}));
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

void add_lengths(CLI::App& command, TrajectoryOptions& options) {
  static const std::map<std::string, double> kUnits{
      {"mm", 0.001}, {"cm", 0.01}, {"m", 1}, {"in", 0.0254}, {"ft", 0.3048}};
  command
      .add_option_function<std::string>(
          "--trajectory-unit",
          [&options](const std::string& name) { options.metres_per_unit = kUnits.at(name); },
          "Unit of the positions: mm, cm, m, in or ft (default: m, or what a header says)")
      ->type_name("UNIT")
      ->check(CLI::IsMember({"mm", "cm", "m", "in", "ft"}));
  command
      .add_option_function<std::vector<double>>(
          "--lever-arm",
          [&lever = options.lever_arm](const std::vector<double>& arm) {
            if (arm.size() != 3 || !std::isfinite(arm[0] + arm[1] + arm[2])) {
              throw CLI::ValidationError("--lever-arm",
                                         "expected three numbers of metres, for example 1.2,0,1.5");
            }
            lever = {arm[0], arm[1], arm[2]};
          },
          "Where the point that the trajectory gives, such as an antenna, lies in the model's "
          "frame, in metres")
      ->delimiter(',')
      ->expected(1)
      ->type_name("X,Y,Z");
}

}  // namespace

void add_trajectory_options(CLI::App& command, TrajectoryOptions& options) {
  add_format(command, options);
  command.add_flag("--allow-non-rigid", options.allow_non_rigid,
                   "Accept matrices that scale or shear");
  add_angles(command, options);
  add_map(command, options);
  add_lengths(command, options);
}

}  // namespace clearway::tool
