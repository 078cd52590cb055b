#include "clearway/alignment.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
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
#include "io/files/text_number.hpp"
#include "io/paths/alignment/alignment_file.hpp"
#include "io/paths/trajectory_file.hpp"

namespace clearway::tool {
namespace {

struct AlignmentCommand {
  std::filesystem::path input, output, environment;
  AlignmentOptions alignment;
  LengthOptions lengths;
  bool force = false;
  bool json = false;
};

struct NamedCant {
  const char* name;
  CantLine line;
};

constexpr std::array<NamedCant, 7> kCants{{{"file", CantLine::kFile},
                                           {"none", CantLine::kNone},
                                           {"center", CantLine::kCenter},
                                           {"inside-rail", CantLine::kInsideRail},
                                           {"outside-rail", CantLine::kOutsideRail},
                                           {"left-rail", CantLine::kLeftRail},
                                           {"right-rail", CantLine::kRightRail}}};

void print_json(const AlignmentFile& made) {
  const nlohmann::ordered_json json{
      {"alignment", made.alignment},
      {"profile",
       made.profile.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(made.profile)},
      {"unit", made.unit},
      {"metres_per_unit", made.metres_per_unit},
      {"alignment_from", made.first_station},
      {"alignment_to", made.last_station},
      {"poses", made.poses.size()},
      {"first_station", made.stations.front()},
      {"last_station", made.stations.back()},
      {"notes", remarks_json(made.remarks, Message::Severity::kNote)},
      {"warnings", remarks_json(made.remarks, Message::Severity::kWarning)}};
  print(indented_text(json));
}

void write_alignment(AlignmentCommand& options) {
  std::vector<std::filesystem::path> inputs{options.input};
  if (!options.environment.empty()) inputs.push_back(options.environment);
  refuse_overwriting(options.output, inputs);
  options.lengths.convert(1);
  if (!options.environment.empty()) {
    options.alignment.environment_crs = Store(options.environment).crs_wkt();
  }
  PendingFile output(options.output, options.force);
  const AlignmentFile made = read_alignment_file(options.input, options.alignment);
  for (const Message& remark : made.remarks) log_message(remark);
  ConsoleProgress progress;
  write_trajectory_table(made.poses, {.station = made.stations}, {.unit = FileUnit::exactly(1)},
                         File::create(output.partial()), progress);
  output.publish();
  spdlog::info(
      "{}: {} in metres, from station {:.3f} m to {:.3f} m of the alignment, whose unit is "
      "the {}",
      options.output.string(), counted(made.poses.size(), "pose"), made.stations.front(),
      made.stations.back(), made.unit);
  if (options.json) print_json(made);
}

/// The check of a station, which is a number and not as signs show it.
CLI::Validator station() {
  const auto check = [](const std::string& text) -> std::string {
    if (parse_whole_number(text)) return "";
    return text + ": expected a number with a decimal point, such as 1100.5 for 1+100.5";
  };
  return {check, ""};
}

/// Adds the options that say which stretch of which alignment is wanted.
void add_way(CLI::App& command, AlignmentCommand& options) {
  const GroupScope group(command, OptionGroup::kPath);
  AlignmentOptions& what = options.alignment;
  command
      .add_option("--alignment", what.alignment, "The alignment's name, where there are several")
      ->type_name("NAME");
  command.add_option("--profile", what.profile, "The profile's name, where there are several")
      ->type_name("NAME");
  options.lengths.add(command, "--step", what.step,
                      "From one pose to the next, along the alignment (default: 0.1)");
  command
      .add_option("--from", what.station_from,
                  "Internal station of the first pose, in the unit of the file")
      ->type_name("STATION")
      ->check(station());
  command
      .add_option("--to", what.station_to,
                  "Internal station of the last pose, in the unit of the file")
      ->type_name("STATION")
      ->check(station());
  command.add_flag("--reverse", what.reverse, "Travel against the stations");
  options.lengths.add(command, "--height", what.height,
                      "Height of all poses, for an alignment without a profile", FieldRange::kAny);
}

void add_order(CLI::App& command, AlignmentOptions& options) {
  command
      .add_option_function<std::string>(
          "--order",
          [&options](const std::string& name) {
            options.order =
                name == "en" ? AxisOrder::kEastingNorthing : AxisOrder::kNorthingEasting;
          },
          "Order of the coordinates: ne (northing, easting, as LandXML has it) or en (default: ne)")
      ->type_name("NAME")
      ->check(CLI::IsMember({"ne", "en"}));
}

/// Adds the options that say how the elements of the file are understood.
void add_track(CLI::App& command, AlignmentCommand& options) {
  const GroupScope group(command, OptionGroup::kUnits);
  AlignmentOptions& what = options.alignment;
  add_cant_option(command, what.cant,
                  "What cant turns the track about, or that there is none (default: file, as it "
                  "says)");
  options.lengths.add(command, "--rail-distance", what.rail_distance,
                      "Between the middles of the rails (default: 1.5 for a gauge of 1.435 or 1.5)",
                      FieldRange::kAboveZero);
  add_order(command, what);
  options.lengths.add(command, "--max-gap", what.max_gap,
                      "The most that an element may miss the next, or its own end (default: 0.001)",
                      FieldRange::kFromZero);
}

}  // namespace

void add_cant_option(CLI::App& command, CantLine& cant, const std::string& description,
                     std::optional<CantLine> without) {
  std::vector<std::string> names;
  for (const NamedCant& known : kCants) {
    if (known.line != without) names.emplace_back(known.name);
  }
  command
      .add_option_function<std::string>(
          "--cant",
          [&cant](const std::string& name) {
            cant = std::ranges::find(kCants, name, &NamedCant::name)->line;
          },
          description)
      ->type_name("NAME")
      ->check(CLI::IsMember(names));
}

void add_trajectory_alignment(CLI::App& trajectory) {
  const auto options = std::make_shared<AlignmentCommand>();
  CLI::App* command = trajectory.add_subcommand(
      "alignment", "Write poses in metres along an alignment of a LandXML file");
  add_file(*command, "IN", options->input, "The LandXML 1.2 file")->required();
  add_file(*command, "-o,--output", options->output,
           "The poses: CSV with the station, the position and the rotation of each")
      ->required();
  add_way(*command, *options);
  add_track(*command, *options);
  add_file(*command, "--env", options->environment,
           "A store: warns where its coordinate system is another than that of the file");
  command->add_flag("--force", options->force, "Overwrite an existing output");
  command->add_flag("--json", options->json, "One JSON object on standard output");
  command->footer("Example: clearway trajectory alignment track.xml -o path.csv --to 1200");
  command->callback([options] {
    run_stoppable(options->output, kStartsAgain, [&] { write_alignment(*options); });
  });
}

}  // namespace clearway::tool
