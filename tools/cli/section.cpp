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
#include "core/util/format.hpp"
#include "io/files/json.hpp"
#include "io/files/pending_file.hpp"
#include "io/files/thread_limit.hpp"
#include "report/section_words.hpp"

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

ordered_json motion_json(const std::optional<std::array<double, 2>>& motion) {
  return motion ? ordered_json(*motion) : ordered_json(nullptr);
}

ordered_json json_of(const SectionReport& report, const FindCommand& options) {
  ordered_json out = program_json({{"env", options.environment},
                                   {"trajectory", options.trajectory},
                                   {"output", options.output}});
  out["blocked"] = report.blocked;
  out["blocked_in_bins"] = report.blocked_in_bins;
  out["bins"] = report.bins;
  out["rounding"] = report.rounding;
  out["motion"] = motion_json(report.motion);
  out["device"] = name_of(report.device);
  out["device_estimate"] = nullptr;
  if (report.estimate) {
    out["device_estimate"] = {{"cpu", report.estimate->cpu}, {"cuda", report.estimate->cuda}};
  }
  if (report.seen) {
    out["seen"] = {{"cube", report.seen->cube},
                   {"unknown", report.seen->unknown},
                   {"unknown_in_bins", report.seen->unknown_in_bins}};
  }
  if (report.ignored_cells) {
    out["ignored_points"] = report.ignored_points;
    out["ignored_cells"] = {{"blocked", report.ignored_cells->blocked},
                            {"high", report.ignored_cells->high}};
  }
  out["needed_host_bytes"] = report.needed_host_bytes;
  out["peak_device_bytes"] = report.peak_device_bytes;
  out["seconds"] = {{"total", report.seconds},
                    {"search", report.search_seconds},
                    {"engine", report.engine_seconds},
                    {"context_wait", report.context_wait_seconds}};
  out["warnings"] = report.warnings;
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
      report.warnings.empty() ? "" : ", but see the " + counted(report.warnings.size(), "warning");
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
  command->add_option("--env", options->environment, "The environment: a store of clearway convert")
      ->type_name("FILE")
      ->required();
  command->add_option("--trajectory", options->trajectory, kTrajectoryHelp)
      ->type_name("FILE")
      ->required();
  command->add_option("-o,--output", options->output, "The section, an HDF5 file")
      ->type_name("FILE")
      ->required();
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

struct CheckCommand {
  std::filesystem::path section;
  LoadInput load;
  SiteInput site;
  LengthOptions lengths;
  bool json = false;
};

using Witnesses = std::vector<std::optional<SectionWitness>>;

ordered_json witness_json(const std::optional<SectionWitness>& witness) {
  if (!witness) return nullptr;
  return {{"source", witness->source},
          {"xyz", {witness->xyz.x, witness->xyz.y, witness->xyz.z}},
          {"class", witness->point_class}};
}

ordered_json stop_json(const SectionStop& stop) {
  return {{"bin", stop.bin},
          {"first_pose", stop.first_pose},
          {"chainage", stop.chainage},
          {"cell", stop.cell}};
}

/// witnesses: of each stop, or empty where nobody asked for them.
ordered_json json_of(const SectionCheck& check, double margin, const Witnesses& witnesses,
                     const Section& section, const CheckCommand& options) {
  ordered_json out =
      program_json({{"section", options.section}, {"outline", options.load.outline}});
  out["margin"] = margin;
  out["verdict"] = name_of(check.verdict);
  out["reason"] = check.reason.empty() ? ordered_json(nullptr) : ordered_json(check.reason);
  out["first_pose"] = out["chainage"] = out["cell"] = nullptr;
  if (check.stop) {
    out["first_pose"] = check.stop->first_pose;
    out["chainage"] = check.stop->chainage;
    out["cell"] = check.stop->cell;
  }
  if (options.site.is_given()) {
    out["witness"] = witnesses.empty() ? ordered_json(nullptr) : witness_json(witnesses.front());
  }
  auto stops = ordered_json::array();
  for (std::size_t i = 0; i < check.stops.size(); ++i) {
    stops.push_back(stop_json(check.stops[i]));
    if (!witnesses.empty()) stops.back()["witness"] = witness_json(witnesses[i]);
  }
  out["stops"] = std::move(stops);
  if (section.data().unknown) {
    auto unknowns = ordered_json::array();
    for (const SectionStop& place : check.unknowns) unknowns.push_back(stop_json(place));
    out["unknowns"] = std::move(unknowns);
  }
  std::vector<Message> warnings = section.data().warnings;
  warnings.insert(warnings.end(), options.load.messages.begin(), options.load.messages.end());
  out["warnings"] = warnings;
  return out;
}

/// The points that stop the load first in each stretch; empty without store and path.
Witnesses witnesses_of(const SectionCheck& check, const Section& section, SiteInput& site) {
  if (!site.is_given()) return {};
  site.read();
  std::vector<SectionPlace> places;
  for (const SectionStop& stop : check.stops) places.push_back({stop.first_pose, stop.cell});
  return section_witnesses(section.data(), *site.store, site.path, places);
}

int run_check(CheckCommand& options) {
  const Section section(options.section);
  const double metres = convert_for(options.lengths, section, options.section);
  const std::vector<OutlinePoint> outline = read_load(options.load, section, metres);
  const double margin = options.load.margin.value_or(section.data().parameters.margin);
  SectionCheck check;
  try {
    check = section.check(outline, margin);
  } catch (const UsageError& error) {
    throw UsageError(options.load.outline.string() + ": " + error.what());
  }
  const Witnesses witnesses = witnesses_of(check, section, options.site);
  for (const Message& warning : section.data().warnings) log_message(warning);
  const std::string sentence = verdict_sentence(check, section.data(), margin);
  if (options.json) {
    spdlog::info("{}", sentence);
    print(indented_text(json_of(check, margin, witnesses, section, options)));
  } else {
    print(sentence + "\n");
  }
  return check.verdict == SectionVerdict::kPasses    ? kDone
         : check.verdict == SectionVerdict::kStopped ? kDiffers
                                                     : kUndecided;
}

void add_section_check(CLI::App& section, int& exit_code) {
  const auto options = std::make_shared<CheckCommand>();
  CLI::App* command = section.add_subcommand(
      "check", "Say whether a load with this outline passes, and where it is stopped");
  command->add_option("SECTION", options->section, "Section of clearway section find")
      ->type_name("FILE")
      ->required();
  add_load_options(*command, options->load, options->lengths)->required();
  add_site_options(*command, options->site, options->lengths);
  command->add_flag("--json", options->json, "Print one JSON object");
  command->footer(
      "Exit code 0: the load passes.\n"
      "Exit code 1: it is stopped.\n"
      "Exit code 6: unknown, because the load with its margin leaves the window, the margin "
      "exceeds\n"
      "that of the section, the section is in doubt, or no beam crossed what the load needs.\n"
      "Example: clearway section check section.h5 --outline load.csv --margin 0.1");
  command->callback([options, &exit_code] { exit_code = run_check(*options); });
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
  command->add_option("SECTION", options->section, "Section of clearway section find")
      ->type_name("FILE")
      ->required();
  command->add_option("-o,--output", options->output, "The table, a CSV file; or the outline, DXF")
      ->type_name("FILE")
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
