#include "clearway/line.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "clearway/store.hpp"
#include "cli/support/console.hpp"
#include "cli/support/lengths.hpp"
#include "cli/support/options.hpp"
#include "cli/support/program_json.hpp"
#include "cli/trajectory/commands.hpp"
#include "cli/trajectory/description.hpp"
#include "core/util/format.hpp"
#include "io/files/json.hpp"
#include "io/files/pending_file.hpp"
#include "io/paths/line/line_file.hpp"
#include "io/paths/trajectory_file.hpp"

namespace clearway::tool {
namespace {

struct LineCommand {
  std::filesystem::path input, output, environment, ground;
  LineOptions line;
  LengthOptions lengths;
  bool force = false;
  bool json = false;
};

void print_json(const LineFile& made) {
  using nlohmann::ordered_json;
  const bool labelled = !made.stations.empty();
  ordered_json ground;
  if (const auto& found = made.ground) {
    ground = {{"places", found->places},
              {"left", found->left},
              {"right", found->right},
              {"risen", found->risen},
              {"longest_bridged", found->longest_bridged}};
  }
  const ordered_json json{
      {"format", made.format},
      {"metres_per_unit", made.metres_per_unit},
      {"vertices", made.vertices},
      {"arcs", made.arcs},
      {"length", made.length},
      {"poses", made.poses.size()},
      {"first_station", labelled ? ordered_json(made.stations.front()) : ordered_json()},
      {"last_station", labelled ? ordered_json(made.stations.back()) : ordered_json()},
      {"ground", ground},
      {"notes", remarks_json(made.remarks, Message::Severity::kNote)},
      {"warnings", remarks_json(made.remarks, Message::Severity::kWarning)}};
  print(indented_text(json));
}

void write_line(LineCommand& options) {
  const bool on_ground = !options.ground.empty();
  const std::filesystem::path& environment = on_ground ? options.ground : options.environment;
  std::vector<std::filesystem::path> inputs{options.input};
  if (!environment.empty()) inputs.push_back(environment);
  refuse_overwriting(options.output, inputs);
  options.lengths.convert(1);
  std::optional<Store> store;
  if (!environment.empty()) {
    store.emplace(environment);
    set_environment_unit(*store, options.line);
    options.line.environment_crs = store->crs_wkt();
    if (on_ground) options.line.ground = &*store;
  }
  PendingFile output(options.output, options.force);
  const LineFile made = read_line_file(options.input, options.line);
  for (const Message& remark : made.remarks) log_message(remark);
  ConsoleProgress progress;
  write_trajectory_table(made.poses, {.station = made.stations},
                         {.unit = FileUnit::exactly(1), .remarks = made.remarks},
                         File::create(output.partial()), progress);
  output.publish();
  spdlog::info("{}: {} in metres, along {} m of a line of {}", options.output.string(),
               counted(made.poses.size(), "pose"), format_brief(made.length),
               counted(made.vertices, "vertex", "vertices"));
  if (options.json) print_json(made);
}

/// Adds the options that say how the path follows the line.
void add_way(CLI::App& command, LineCommand& options) {
  const GroupScope group(command, OptionGroup::kPath);
  LineOptions& what = options.line;
  options.lengths.add(command, "--step", what.step,
                      "From one pose to the next, along the line (default: 0.1)");
  command.add_flag("--reverse", what.reverse, "Travel from the last vertex to the first");
  options.lengths.add(command, "--corner-radius", what.corner_radius,
                      "Put arcs of this radius at the vertices, between straight legs (default: a "
                      "smooth curve through the vertices, which may turn by 15 degrees at most)",
                      FieldRange::kAboveZero);
  options.lengths.add(command, "--height", what.height,
                      "Height of all poses, for a line without heights; on the ground: about where "
                      "it begins",
                      FieldRange::kAny);
}

/// Adds the options that put the path on the ground of a scan.
void add_ground(CLI::App& command, LineCommand& options) {
  const GroupScope group(command, OptionGroup::kPath);
  CLI::Option* ground =
      add_file(command, "--on-ground", options.ground,
               "A store: height and roll are those of its ground under the wheels; under a "
               "parked car, whose ground is not seen, about 0.3 m too high");
  CLI::Option* track = options.lengths.add(command, "--track", options.line.track,
                                           "Between the middles of the left and the right wheels",
                                           FieldRange::kAboveZero);
  ground->needs(track);
  track->needs(ground);
}

/// Adds the options that say how the numbers of the file are understood.
void add_reading(CLI::App& command, LineCommand& options) {
  const GroupScope group(command, OptionGroup::kUnits);
  LineOptions& what = options.line;
  add_unit_option(
      command, "--trajectory-unit", what.unit,
      "Unit of the coordinates; ft is the environment's foot, ift the international and "
      "us-ft the US survey foot (default: what a header says, otherwise that of the "
      "environment)");
  add_cant_option(command, what.cant,
                  "What a column of cant turns the track about, which the line then is, or that "
                  "there is none (default: center)",
                  CantLine::kFile);
  options.lengths.add(
      command, "--rail-distance", what.rail_distance,
      "Between the middles of the rails, over which cant is measured (default: 1.5)",
      FieldRange::kAboveZero);
}

}  // namespace

void add_trajectory_line(CLI::App& trajectory) {
  const auto options = std::make_shared<LineCommand>();
  CLI::App* command =
      trajectory.add_subcommand("line", "Write poses in metres along a line of CSV or GeoJSON");
  add_file(*command, "IN", options->input,
           "The line: CSV with the columns x, y and, where it has them, z, station and cant; "
           "or GeoJSON with one LineString")
      ->required();
  add_file(*command, "-o,--output", options->output,
           "The poses: CSV with the position and the rotation of each, and its station if "
           "the line has stations")
      ->required();
  add_way(*command, *options);
  add_ground(*command, *options);
  add_reading(*command, *options);
  add_file(*command, "--env", options->environment,
           "A store: says the unit of a line that names none, and which foot a ft is; warns "
           "where its coordinate system is another than that of the file")
      ->excludes("--on-ground");
  command->add_flag("--force", options->force, "Overwrite an existing output");
  command->add_flag("--json", options->json, "One JSON object on standard output");
  command->footer(
      "Example: clearway trajectory line route.csv -o path.csv --corner-radius 12 --on-ground "
      "site.h5 --track 1.6");
  command->callback(
      [options] { run_stoppable(options->output, kStartsAgain, [&] { write_line(*options); }); });
}

}  // namespace clearway::tool
