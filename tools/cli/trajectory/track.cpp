#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "clearway/alignment.hpp"
#include "clearway/line.hpp"
#include "cli/support/field_options.hpp"
#include "cli/trajectory/commands.hpp"
#include "core/describe/trajectory.hpp"
#include "core/util/format.hpp"
#include "io/files/json.hpp"
#include "io/files/text_number.hpp"
#include "io/paths/alignment/alignment_file.hpp"
#include "io/paths/line/line_file.hpp"

/// Paths that are made along the alignment of a track or along a line.
namespace clearway::tool {
namespace {

struct AlignmentCommand : PoseCommand {
  AlignmentOptions alignment;
};

struct LineCommand : PoseCommand {
  std::filesystem::path ground;
  LineOptions line;
};

/// Logs the remarks on what the poses are made along, and writes them with their stations.
void write_along(const PosesAlong& made, const std::filesystem::path& file) {
  for (const Message& remark : made.remarks) log_message(remark);
  ConsoleProgress progress;
  write_trajectory_table(made.poses, {.station = made.stations},
                         {.unit = FileUnit::exactly(1), .remarks = made.remarks},
                         File::create(file), progress);
}

WrittenPoses written(const AlignmentFile& made) {
  Json report{{"alignment", made.alignment},
              {"profile", made.profile.empty() ? Json() : Json(made.profile)},
              {"unit", made.unit},
              {"metres_per_unit", made.metres_per_unit},
              {"alignment_from", made.first_station},
              {"alignment_to", made.last_station},
              {"poses", made.poses.size()},
              {"first_station", made.stations.front()},
              {"last_station", made.stations.back()}};
  add_remarks(report, made.remarks);
  return {fmt::format("{} in metres, from station {:.3f} m to {:.3f} m of the alignment, whose "
                      "unit is the {}",
                      counted(made.poses.size(), "pose"), made.stations.front(),
                      made.stations.back(), made.unit),
          std::move(report)};
}

void write_alignment(AlignmentCommand& options) {
  refuse_overwriting_inputs(options);
  options.lengths.convert(1);
  if (!options.environment.empty()) {
    options.alignment.environment_crs = Store(options.environment).crs_wkt();
  }
  write_output(options, [&](const std::filesystem::path& file) {
    const AlignmentFile made = read_alignment_file(options.input, options.alignment);
    write_along(made, file);
    return written(made);
  });
}

WrittenPoses written(const LineFile& made) {
  const bool labelled = !made.stations.empty();
  Json report{{"format", made.format},
              {"metres_per_unit", made.metres_per_unit},
              {"vertices", made.vertices},
              {"arcs", made.arcs},
              {"length", made.length},
              {"poses", made.poses.size()},
              {"first_station", labelled ? Json(made.stations.front()) : Json()},
              {"last_station", labelled ? Json(made.stations.back()) : Json()},
              {"ground", nullptr}};
  if (const auto& found = made.ground) {
    report["ground"] = {{"places", found->places},
                        {"left", found->left},
                        {"right", found->right},
                        {"risen", found->risen},
                        {"longest_bridged", found->longest_bridged}};
  }
  add_remarks(report, made.remarks);
  return {
      fmt::format("{} in metres, along {} m of a line of {}", counted(made.poses.size(), "pose"),
                  format_brief(made.length), counted(made.vertices, "vertex", "vertices")),
      std::move(report)};
}

void write_line(LineCommand& options) {
  const bool on_ground = !options.ground.empty();
  if (on_ground) options.environment = options.ground;
  refuse_overwriting_inputs(options);
  options.lengths.convert(1);
  std::optional<Store> store;
  if (!options.environment.empty()) {
    store.emplace(options.environment);
    set_environment_unit(*store, options.line);
    options.line.environment_crs = store->crs_wkt();
    if (on_ground) options.line.ground = &*store;
  }
  write_output(options, [&](const std::filesystem::path& file) {
    const LineFile made = read_line_file(options.input, options.line);
    write_along(made, file);
    return written(made);
  });
}

/// Adds an option for a station, which is a number and not as signs show it.
void add_station(CLI::App& command, const char* name, std::optional<double>& station,
                 const char* help) {
  const auto check = [](const std::string& text) -> std::string {
    if (parse_whole_number(text)) return "";
    return text + ": expected a number with a decimal point, such as 1100.5 for 1+100.5";
  };
  command.add_option(name, station, help)->type_name("STATION")->check(CLI::Validator(check, ""));
}

void add_alignment_options(CLI::App& command, AlignmentCommand& options) {
  AlignmentOptions& what = options.alignment;
  LengthOptions& lengths = options.lengths;
  {
    const GroupScope path(command, OptionGroup::kPath);
    command
        .add_option("--alignment", what.alignment, "The alignment's name, where there are several")
        ->type_name("NAME");
    command.add_option("--profile", what.profile, "The profile's name, where there are several")
        ->type_name("NAME");
    lengths.add(command, "--step", what.step,
                "From one pose to the next, along the alignment (default: 0.1)");
    add_station(command, "--from", what.station_from,
                "Internal station of the first pose, in the unit of the file");
    add_station(command, "--to", what.station_to,
                "Internal station of the last pose, in the unit of the file");
    command.add_flag("--reverse", what.reverse, "Travel against the stations");
    lengths.add(command, "--height", what.height,
                "Height of all poses, for an alignment without a profile", FieldRange::kAny);
  }
  {
    const GroupScope units(command, OptionGroup::kUnits);
    add_choice(
        command, "--cant", what.cant, "NAME",
        "What cant turns the track about, or that there is none (default: file, as it says)");
    lengths.add(command, "--rail-distance", what.rail_distance,
                "Between the middles of the rails (default: 1.5 for a gauge of 1.435 or 1.5)");
    add_choice(
        command, "--order", what.order, "NAME",
        "Order of the coordinates: ne (northing, easting, as LandXML has it) or en (default: ne)");
    lengths.add(command, "--max-gap", what.max_gap,
                "The most that an element may miss the next, or its own end (default: 0.001)",
                FieldRange::kFromZero);
  }
  add_file(command, "--env", options.environment,
           "A store: warns where its coordinate system is another than that of the file");
}

void add_line_options(CLI::App& command, LineCommand& options) {
  LineOptions& what = options.line;
  LengthOptions& lengths = options.lengths;
  {
    const GroupScope path(command, OptionGroup::kPath);
    lengths.add(command, "--step", what.step,
                "From one pose to the next, along the line (default: 0.1)");
    command.add_flag("--reverse", what.reverse, "Travel from the last vertex to the first");
    lengths.add(command, "--corner-radius", what.corner_radius,
                "Put arcs of this radius at the vertices, between straight legs (default: a "
                "smooth curve through the vertices, which may turn by 15 degrees at most)");
    lengths.add(command, "--height", what.height,
                "Height of all poses, for a line without heights; on the ground: about where "
                "it begins",
                FieldRange::kAny);
    CLI::Option* ground =
        add_file(command, "--on-ground", options.ground,
                 "A store: height and roll are those of its ground under the wheels; under a "
                 "parked car, whose ground is not seen, about 0.3 m too high");
    CLI::Option* track = lengths.add(command, "--track", what.track,
                                     "Between the middles of the left and the right wheels");
    ground->needs(track);
    track->needs(ground);
  }
  {
    const GroupScope units(command, OptionGroup::kUnits);
    add_unit_option(
        command, "--trajectory-unit", what.unit,
        "Unit of the coordinates; ft is the environment's foot, ift the international and "
        "us-ft the US survey foot (default: what a header says, otherwise that of the "
        "environment)");
    // A line does not say itself what its cant turns it about.
    add_choice(command, "--cant", what.cant, "NAME",
               "What a column of cant turns the track about, which the line then is, or that "
               "there is none (default: center)",
               std::span(kChoices<CantLine>).subspan(1));
    lengths.add(command, "--rail-distance", what.rail_distance,
                "Between the middles of the rails, over which cant is measured (default: 1.5)");
  }
  add_file(command, "--env", options.environment,
           "A store: says the unit of a line that names none, and which foot a ft is; warns "
           "where its coordinate system is another than that of the file")
      ->excludes("--on-ground");
}

}  // namespace

void add_trajectory_alignment(CLI::App& trajectory) {
  add_writer<AlignmentCommand>(
      trajectory,
      {"alignment", "Write poses in metres along an alignment of a LandXML file",
       "The LandXML 1.2 file",
       "The poses: CSV with the station, the position and the rotation of each",
       "Example: clearway trajectory alignment track.xml -o path.csv --to 1200"},
      add_alignment_options, write_alignment);
}

void add_trajectory_line(CLI::App& trajectory) {
  add_writer<LineCommand>(
      trajectory,
      {"line", "Write poses in metres along a line of CSV or GeoJSON",
       "The line: CSV with the columns x, y and, where it has them, z, station and cant; or "
       "GeoJSON with one LineString",
       "The poses: CSV with the position and the rotation of each, and its station if the line has "
       "stations",
       "Example: clearway trajectory line route.csv -o path.csv --corner-radius 12 --on-ground "
       "site.h5 --track 1.6"},
      add_line_options, write_line);
}

}  // namespace clearway::tool
