#include "cli/section_inputs.hpp"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "cli/input_roles.hpp"
#include "cli/support/console.hpp"
#include "cli/support/options.hpp"
#include "cli/support/trajectory_options.hpp"
#include "core/util/format.hpp"
#include "io/scans/length_unit.hpp"
#include "search/section.hpp"

namespace clearway::tool {

void add_load_options(CLI::App& command, LoadInput& load, LengthOptions& lengths) {
  CLI::Option* outline =
      add_file(command, "--outline", load.outline,
               "The outline of the load as text: y,z of each corner in a line, y to the "
               "left and z up, or with --mirror height,half_width");
  add_file(command, "--table", load.table,
           "Outlines by stretches of the path: CSV with chainage_from,chainage_to (or "
           "station_from,station_to),outline,margin; outline files are relative to it")
      ->excludes(outline);
  lengths.add(command, "--margin", load.margin,
              "Distance to keep on all sides; at most that of the section, which is the default; "
              "of a table, for rows without a margin",
              FieldRange::kFromZero);
  command.add_flag("--mirror", load.how.mirror,
                   "The file has height,half_width of the one half of a symmetric outline");
  add_outline_unit(command, load.how.unit);
}

double convert_for(const LengthOptions& lengths, const Section& section,
                   const std::filesystem::path& file) {
  return lengths.convert_for(file.string(), section.data().crs_wkt, section.data().length_unit);
}

namespace {

/// How the outlines of a load are read for a section whose unit has so many metres. Warns where a
/// unit is named and that of the section is not known.
OutlineOptions outline_options(const LoadInput& load, const Section& section, double metres) {
  OutlineOptions how = load.how;
  how.environment_unit = metres;
  if (how.unit.is_known() && length_unit_of(section.data().length_unit) == LengthUnit::kUnknown &&
      (is_foot(how.unit.metres()) || how.unit.metres() == kMetresPerInch)) {
    spdlog::warn("{}", unit_assumed_text("corners of the outline", how.unit.metres()));
  }
  return how;
}

}  // namespace

std::vector<OutlinePoint> read_load(LoadInput& load, const Section& section, double metres) {
  const OutlineOptions how = outline_options(load, section, metres);
  std::vector<OutlinePoint> outline = read_outline(load.outline, how, &load.messages);
  for (const Message& message : load.messages) log_message(message);
  return outline;
}

OutlineTable read_load_table(LoadInput& load, const Section& section, double metres) {
  const OutlineOptions how = outline_options(load, section, metres);
  OutlineTable table = read_outline_table(load.table, how, &load.messages);
  for (const Message& message : load.messages) log_message(message);
  return table;
}

void add_site_options(CLI::App& command, SiteInput& site, LengthOptions& lengths) {
  CLI::Option* environment =
      add_file(command, "--env", site.environment,
               "The store that the section was found in: the points that stop the load are "
               "looked up there");
  CLI::Option* trajectory =
      add_file(command, "--trajectory", site.trajectory,
               "The path that the section was found for, with --env or for a table by "
               "station");
  environment->needs(trajectory);
  add_trajectory_options(command, site.trajectory_options, lengths);
}

void check_site(const SiteInput& site, const OutlineTable* table) {
  const bool by_station = table != nullptr && table->by_station;
  if (by_station && site.trajectory.empty()) {
    throw UsageError(table->path.string() +
                     ": its rows are by station; expected --trajectory, whose poses have stations");
  }
  if (!site.trajectory.empty() && !site.has_store() && !by_station) {
    throw UsageError("--trajectory needs --env, unless it gives the stations of --table");
  }
}

void SiteInput::read(const Section& section, double metres) {
  if (trajectory.empty()) return;
  check_is_trajectory(trajectory);
  if (has_store()) {
    check_is_store(environment);
    store.emplace(environment);
    set_environment_unit(*store, trajectory_options);
    trajectory_options.default_crs = store->crs_wkt();
  } else {
    trajectory_options.environment_unit = metres;
    trajectory_options.default_crs = section.data().crs_wkt;
  }
  std::vector<Message> messages;
  path = read_trajectory(trajectory, trajectory_options, &messages, &labels);
  for (const Message& message : messages) log_message(message);
  check_path_of(section.data(), path);
}

}  // namespace clearway::tool
