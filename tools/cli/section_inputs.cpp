#include "cli/section_inputs.hpp"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "cli/input_roles.hpp"
#include "cli/support/console.hpp"
#include "cli/support/options.hpp"
#include "cli/support/trajectory_options.hpp"
#include "core/util/format.hpp"
#include "io/scans/length_unit.hpp"

namespace clearway::tool {

CLI::Option* add_load_options(CLI::App& command, LoadInput& load, LengthOptions& lengths) {
  CLI::Option* outline =
      command
          .add_option("--outline", load.outline,
                      "The outline of the load as text: y,z of each corner in a line, y to the "
                      "left and z up, or with --mirror height,half_width")
          ->type_name("FILE");
  lengths.add(command, "--margin", load.margin,
              "Distance to keep on all sides; at most that of the section, which is the default",
              FieldRange::kFromZero);
  command.add_flag("--mirror", load.how.mirror,
                   "The file has height,half_width of the one half of a symmetric outline");
  add_outline_unit(command, load.how.unit);
  return outline;
}

double convert_for(const LengthOptions& lengths, const Section& section,
                   const std::filesystem::path& file) {
  const LengthUnit unit = length_unit_of(section.data().length_unit);
  if (unit == LengthUnit::kUnknown) {
    return lengths.convert_for(file.string(), section.data().crs_wkt);
  }
  const double metres = unit == LengthUnit::kDegrees ? 1 : metres_of(unit);
  lengths.convert(metres);
  return metres;
}

std::vector<OutlinePoint> read_load(LoadInput& load, const Section& section, double metres) {
  std::vector<OutlinePoint> outline =
      read_outline(load.outline, {.mirror = load.how.mirror}, &load.messages);
  for (const Message& message : load.messages) log_message(message);
  const FileUnit& unit = load.how.unit;
  if (!unit.is_known()) return outline;
  if (length_unit_of(section.data().length_unit) == LengthUnit::kUnknown &&
      (is_foot(unit.metres()) || unit.metres() == kMetresPerInch)) {
    spdlog::warn("{}", unit_assumed_text("corners of the outline", unit.metres()));
  }
  const UnitFactor factor(unit.metres_in(metres), metres);
  for (OutlinePoint& p : outline) p = {factor(p.y), factor(p.z)};
  return outline;
}

void add_site_options(CLI::App& command, SiteInput& site, LengthOptions& lengths) {
  CLI::Option* environment =
      command
          .add_option("--env", site.environment,
                      "The store that the section was found in: the points that stop the load are "
                      "looked up there")
          ->type_name("FILE");
  CLI::Option* trajectory =
      command
          .add_option("--trajectory", site.trajectory, "The path that the section was found for")
          ->type_name("FILE");
  environment->needs(trajectory);
  trajectory->needs(environment);
  add_trajectory_options(command, site.trajectory_options, lengths);
}

void SiteInput::read() {
  if (!is_given()) return;
  check_is_trajectory(trajectory);
  check_is_store(environment);
  store.emplace(environment);
  set_environment_unit(*store, trajectory_options);
  trajectory_options.default_crs = store->crs_wkt();
  std::vector<Message> messages;
  path = read_trajectory(trajectory, trajectory_options, &messages);
  for (const Message& message : messages) log_message(message);
}

}  // namespace clearway::tool
