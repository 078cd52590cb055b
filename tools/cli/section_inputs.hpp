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

/// The outline of a load, or a table of outlines by stretches of the path, and the distance to
/// keep; none: that of the section.
struct LoadInput {
  std::filesystem::path outline, table;
  OutlineOptions how;
  std::optional<double> margin;
  std::vector<Message> messages = {};  ///< of reading the outlines

  bool is_given() const { return !outline.empty() || !table.empty(); }
};

/// What --base is.
inline constexpr const char* kBaseHelp =
    "Height at which the first band begins, in the window (default: 0, or the bottom of a window "
    "without z = 0)";

/// Adds --outline and --table, which exclude each other, --margin, --mirror and --unit.
void add_load_options(CLI::App& command, LoadInput& load, LengthOptions& lengths);

/// Converts the lengths that were given with a unit into the unit of a section, and returns the
/// metres of that unit; 1, and a warning where a length names a unit, where it is not known.
double convert_for(const LengthOptions& lengths, const Section& section,
                   const std::filesystem::path& file);

/// The outline in the unit of the section, which has so many metres. Where no unit is named, the
/// file is in that unit. Logs what is odd about the outline, and keeps it in load.messages.
std::vector<OutlinePoint> read_load(LoadInput& load, const Section& section, double metres);

/// The table of outlines, likewise.
OutlineTable read_load_table(LoadInput& load, const Section& section, double metres);

/// Store and path of a section, from which the points that block cells are found.
struct SiteInput {
  std::filesystem::path environment, trajectory;
  TrajectoryOptions trajectory_options;
  std::optional<Store> store = {};
  std::vector<Pose> path = {};
  PoseLabels labels = {};

  bool has_store() const { return !environment.empty(); }
  /// Opens the store and reads the path, where they are given, and warns as reading does. metres:
  /// of the section's unit. Throws InputError where one is not what it should be, or the path is
  /// not that of the section.
  void read(const Section& section, double metres);
};

/// Throws UsageError unless a table of outlines by station comes with a path that has stations, and
/// a path with a store or such a table.
void check_site(const SiteInput& site, const OutlineTable* table);

/// Adds `section check`.
void add_section_check(CLI::App& section, int& exit_code);

/// Adds --env and --trajectory, and how the trajectory is read.
void add_site_options(CLI::App& command, SiteInput& site, LengthOptions& lengths);

}  // namespace clearway::tool
