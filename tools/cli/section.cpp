#include "clearway/section.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "clearway/error.hpp"
#include "clearway/outline.hpp"
#include "clearway/store.hpp"
#include "clearway/trajectory.hpp"
#include "cli/commands.hpp"
#include "cli/input_roles.hpp"
#include "cli/run_options.hpp"
#include "cli/section_inputs.hpp"
#include "cli/support/console.hpp"
#include "cli/support/field_options.hpp"
#include "cli/support/lengths.hpp"
#include "cli/support/options.hpp"
#include "cli/support/program.hpp"
#include "cli/support/program_json.hpp"
#include "cli/support/trajectory_options.hpp"
#include "core/describe/section.hpp"
#include "core/describe/section_report.hpp"
#include "core/util/format.hpp"
#include "io/files/facts_json.hpp"
#include "io/files/pending_file.hpp"
#include "io/files/thread_limit.hpp"

namespace clearway::tool {
namespace {

using nlohmann::ordered_json;

struct FindCommand {
  std::filesystem::path environment, trajectory, output;
  std::optional<std::array<double, 2>> x_range, pivots;
  std::optional<std::array<double, 4>> window;
  SectionParameters asked;
  SectionOptions search;
  LengthOptions lengths;
  TrajectoryOptions trajectory_options;
  bool json = false;
};

ordered_json json_of(const SectionReport& report, const FindCommand& options) {
  ordered_json out = program_json({{"env", options.environment},
                                   {"trajectory", options.trajectory},
                                   {"output", options.output}});
  add_facts(out, report);
  return out;
}

SectionParameters parameters_of(const FindCommand& options) {
  SectionParameters asked = options.asked;
  asked.rear = (*options.x_range)[0];
  asked.front = (*options.x_range)[1];
  if (options.window) {
    const auto& [y_from, y_to, z_from, z_to] = *options.window;
    asked.window = SectionWindow{y_from, y_to, z_from, z_to};
  }
  if (options.pivots) asked.pivots = BodyPivots{(*options.pivots)[0], (*options.pivots)[1]};
  return asked;
}

std::vector<Pose> read_path(FindCommand& options, const Store& store) {
  std::vector<Message>& messages = options.search.input_warnings;
  options.trajectory_options.default_crs = store.crs_wkt();
  const std::size_t before = messages.size();
  std::vector<Pose> path =
      read_trajectory(options.trajectory, options.trajectory_options, &messages);
  check_has_poses(path, options.trajectory);
  if (options.lengths.all_have_units() &&
      names_unit(options.trajectory_options.metres_per_unit,
                 std::span<const Message>(messages).subspan(before))) {
    if (auto note = note_on_feet(store)) messages.push_back(std::move(*note));
  }
  for (const Message& message : messages) log_message(message);
  return path;
}

void run_find(FindCommand& options) {
  ConsoleProgress progress;
  watch_call(options.search, progress);
  refuse_overwriting(options.output, {options.environment, options.trajectory});
  check_is_trajectory(options.trajectory);
  check_is_store(options.environment);
  const Store store(options.environment);
  if (auto warning = options.lengths.convert_for(store)) {
    options.search.input_warnings.push_back(std::move(*warning));
  }
  set_environment_unit(store, options.trajectory_options);
  const std::vector<Pose> path =
      in_threads(options.search.threads, [&] { return read_path(options, store); });
  const SectionReport report =
      find_section(store, path, parameters_of(options), options.output, options.search);
  const std::string unit = symbol_of_unit(store.length_unit());
  if (report.motion) {
    spdlog::info("from a pose to the next the load moves by up to {} {} along and {} {} across",
                 format_brief((*report.motion)[0]), unit, format_brief((*report.motion)[1]), unit);
  }
  const std::string doubts =
      report.warnings.empty() ? "" : "; see the " + counted(report.warnings.size(), "warning");
  const std::string unknown =
      !report.seen ? ""
                   : ", and " + format_count(report.seen->unknown) +
                         " more are not known, because no beam of the scanner crossed them";
  const std::string ignored = !report.ignored_cells || report.ignored_cells->blocked == 0
                                  ? ""
                                  : ", and " + format_count(report.ignored_cells->blocked) +
                                        " more would be by points that were ignored";
  const std::string sentence =
      fmt::format("{} of the cross-section {} blocked somewhere on the path, in {} of it{}{}",
                  counted(report.blocked, "cell"), report.blocked == 1 ? "is" : "are",
                  counted(report.bins, "stretch", "stretches"), unknown + ignored, doubts);
  spdlog::info("{}: {}; {}{:.2f} s", options.output.string(), sentence,
               report.device == Device::kCuda ? "on " + report.device_name + ", " : "",
               report.seconds);
  print(options.json ? indented_text(json_of(report, options)) : sentence + "\n");
}

void add_question(CLI::App& command, FindCommand& options) {
  const GroupScope group(command, OptionGroup::kQuestion);
  options.lengths
      .add(command, "--x-range", options.x_range,
           "Rear and front of the load along the vehicle, from its origin")
      ->group(title_of(OptionGroup::kInputs))
      ->type_name("REAR,FRONT")
      ->required();
  options.lengths
      .add(command, "--pivots", options.pivots,
           "Two places of the load lie on the path, so many metres ahead or behind; "
           "without it the load has the poses of the path")
      ->type_name("FRONT,REAR");
  options.lengths
      .add(command, "--window", options.window,
           "The part of the cross-section: y to the left from and to, z up from and to (default: "
           "-4,4,0,6 m)")
      ->type_name("Y0,Y1,Z0,Z1");
  add_fields(command, kSectionFields, options.asked, options.lengths);
}

void add_find(CLI::App& section) {
  const auto options = std::make_shared<FindCommand>();
  CLI::App* command = section.add_subcommand(
      "find", "Find which cells of the cross-section are blocked for a load of this length");
  add_file(*command, "--env", options->environment, "The environment: a store of clearway convert")
      ->required();
  add_file(*command, "--trajectory", options->trajectory, kTrajectoryHelp)->required();
  add_file(*command, "-o,--output", options->output, "The section, an HDF5 file")->required();
  add_question(*command, *options);
  add_trajectory_options(*command, options->trajectory_options, options->lengths);
  add_fields(*command, kMachineFields<SectionOptions>, options->search, options->lengths);
  command->add_flag("--force", options->search.overwrite, "Overwrite an existing section");
  command->add_flag("--strict", options->search.strict,
                    "Treat warnings as errors: no section is written (exit code 3)");
  command->add_flag("--json", options->json, "Print one JSON object");
  command->footer(
      "The load may have any outline; only its rear and front are given here. Every point that it\n"
      "passes blocks a cell, and clearway section check and export answer from the file.\n"
      "A part of the scan without points looks free unless --seen asks what the beams crossed.\n"
      "Example: clearway section find --env site.h5 --trajectory path.txt --x-range=-15,15 "
      "--pivots 10,-10 -o section.h5");
  command->callback(
      [options] { run_stoppable(options->output, kStartsAgain, [&] { run_find(*options); }); });
}

struct ExportCommand {
  std::filesystem::path section, output;
  std::optional<SectionTable> table;
  bool outline = false;
  SectionHeights heights;
  LengthOptions lengths;
  bool force = false;
};

void run_export(ExportCommand& options) {
  refuse_overwriting(options.output, {options.section});
  const Section section(options.section);
  convert_for(options.lengths, section, options.section);
  for (const Message& warning : section.data().warnings) log_message(warning);
  if (!options.table) {
    export_section_outline(section, options.output, options.heights, options.force);
  } else {
    export_section(section, *options.table, options.output, options.heights, options.force);
  }
}

void add_export_of_section(CLI::App& section) {
  constexpr std::array kTables{SectionTable::kBands,          SectionTable::kStations,
                               SectionTable::kBoxes,          SectionTable::kCells,
                               SectionTable::kBinCells,       SectionTable::kUnknownCells,
                               SectionTable::kUnknownBinCells};
  const auto options = std::make_shared<ExportCommand>();
  CLI::App* command = section.add_subcommand(
      "export", "Write the widths of a section as a table, or the largest outline as DXF");
  add_file(*command, "SECTION", options->section, "Section of clearway section find")->required();
  add_file(*command, "-o,--output", options->output, "The table, a CSV file; or the outline, DXF")
      ->required();
  std::vector<std::string> names;
  for (const SectionTable table : kTables) names.emplace_back(name_of(table));
  CLI::Option* table =
      command
          ->add_option_function<std::string>(
              "--table",
              [options, kTables](const std::string& name) {
                for (const SectionTable known : kTables) {
                  if (name == name_of(known)) options->table = known;
                }
              },
              "bands: widths for each height. stations: and for each stretch of the path. boxes: "
              "widths from the base up to each height. cells, bin-cells: the blocked cells. "
              "unknown-cells, unknown-bin-cells: with section find --seen, those that no beam "
              "crossed")
          ->type_name("NAME")
          ->check(CLI::IsMember(names));
  command
      ->add_flag("--outline", options->outline,
                 "Write the outline of the largest load that stands on the base, as DXF; looking "
                 "forward, its x is to the right")
      ->excludes(table);
  options->lengths.add(*command, "--band", options->heights.band,
                       "Height of a band (default: 0.1 m)");
  options->lengths.add(*command, "--base", options->heights.base, kBaseHelp, FieldRange::kAny);
  command->add_flag("--force", options->force, "Overwrite an existing output");
  command->footer(
      "Widths end at the border of the nearest blocked cell, so a load has to be narrower.\n"
      "The DXF file is a drawing that looks forward, with x to the right; outlines for clearway\n"
      "section check have y to the left.\n"
      "Example: clearway section export section.h5 --table bands --base 0.5 -o bands.csv");
  command->callback([options] {
    if (!options->table && !options->outline) {
      throw UsageError(
          "expected --table with the name of a table, for example --table bands, or --outline");
    }
    run_stoppable(options->output, kStartsAgain, [&] { run_export(*options); });
  });
}

}  // namespace

void add_section(CLI::App& program, int& exit_code) {
  CLI::App* command = program.add_subcommand(
      "section", "Find the largest load that passes on a path, and where a load is stopped");
  command->require_subcommand(1);
  add_find(*command);
  add_section_check(*command, exit_code);
  add_export_of_section(*command);
}

}  // namespace clearway::tool
