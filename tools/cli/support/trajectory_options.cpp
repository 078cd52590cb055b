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

/// Sets what the word names, if it is one of the choices. Returns whether it is.
template <typename Value>
bool declare(Value& what, std::string_view word) {
  for (const auto& [name, value] : kChoices<Value>) {
    if (value == Value::kDeclared || word != name) continue;
    if (what != Value::kDeclared && what != value) {
      throw CLI::ValidationError("--angles",
                                 std::string(word) + " contradicts what stands before it");
    }
    what = value;
    return true;
  }
  return false;
}

void set_angles(TrajectoryOptions& options, const std::string& text) {
  std::vector<std::string_view> words;
  split_fields(text, ',', words);
  for (const std::string_view word : words) {
    if (declare(options.angle_unit, word) || declare(options.angle_frame, word)) continue;
    throw CLI::ValidationError(
        "--angles",
        std::string(word) + ": expected deg or rad, and ned or enu, for example deg,ned");
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
