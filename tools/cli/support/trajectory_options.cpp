#include "cli/support/trajectory_options.hpp"

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "cli/support/field_options.hpp"
#include "cli/support/lengths.hpp"
#include "cli/support/options.hpp"
#include "core/describe/trajectory.hpp"
#include "io/scans/text/text_table.hpp"

namespace clearway::tool {
namespace {

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
  const GroupScope group(command, OptionGroup::kUnits);
  command
      .add_option_function<std::string>(
          "--angles", [&options](const std::string& text) { set_angles(options, text); },
          "Roll, pitch and yaw of the trajectory: deg or rad, and ned (heading clockwise from "
          "north) or enu (yaw counter-clockwise from east), for example deg,ned")
      ->type_name("NAME,...");
}

}  // namespace

void add_trajectory_options(CLI::App& command, TrajectoryOptions& options, LengthOptions& lengths) {
  add_angles(command, options);
  add_fields(command, kTrajectoryFields, options, lengths);
}

void add_options_of_reading(CLI::App& command, TrajectoryOptions& options, LengthOptions& lengths) {
  add_angles(command, options);
  add_fields(command, kReadingFields, options, lengths);
}

}  // namespace clearway::tool
