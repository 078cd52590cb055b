#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "clearway/outline.hpp"
#include "clearway/section.hpp"
#include "clearway/store.hpp"
#include "clearway/trajectory.hpp"
#include "cli/support/lengths.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

/// What several commands on a section are given besides its file.
namespace clearway::tool {

/// The outline of a load and the distance that it keeps; none: that of the section.
struct LoadInput {
  std::filesystem::path outline;
  OutlineOptions how;
  std::optional<double> margin;
  std::vector<Message> messages = {};  ///< of reading the outline
};

/// What --base is.
inline constexpr const char* kBaseHelp =
    "Height at which the first band begins, in the window (default: 0, or the bottom of a window "
    "without z = 0)";

/// Adds --outline, --margin, --mirror and --unit, and returns the first.
CLI::Option* add_load_options(CLI::App& command, LoadInput& load, LengthOptions& lengths);

/// Converts the lengths that were given with a unit into the unit of a section, and returns the
/// metres of that unit; 1, and a warning where a length names a unit, where it is not known.
double convert_for(const LengthOptions& lengths, const Section& section,
                   const std::filesystem::path& file);

/// The outline in the unit of the section, which has so many metres. Where no unit is named, the
/// file is in that unit. Logs what is odd about the outline, and keeps it in load.messages.
std::vector<OutlinePoint> read_load(LoadInput& load, const Section& section, double metres);

/// Store and path of a section, from which the points that block cells are found.
struct SiteInput {
  std::filesystem::path environment, trajectory;
  TrajectoryOptions trajectory_options;
  std::optional<Store> store = {};
  std::vector<Pose> path = {};

  bool is_given() const { return !environment.empty(); }
  /// Opens the store and reads the path. Throws InputError where one is not what it should be.
  void read();
};

/// Adds --env and --trajectory, which need each other, and how the trajectory is read.
void add_site_options(CLI::App& command, SiteInput& site, LengthOptions& lengths);

}  // namespace clearway::tool
