#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/trajectory.hpp"
#include "cli/commands.hpp"
#include "cli/run_again.hpp"
#include "cli/support/console.hpp"
#include "cli/support/ignored_options.hpp"
#include "cli/support/lengths.hpp"
#include "cli/support/options.hpp"
#include "cli/support/program_json.hpp"
#include "cli/support/trajectory_options.hpp"
#include "cli/verdict.hpp"
#include "core/util/format.hpp"
#include "io/files/json.hpp"
#include "io/files/pending_file.hpp"
#include "io/paths/content_hash.hpp"
#include "io/result/answer.hpp"
#include "io/result/export/export_result.hpp"
#include "io/result/export/export_scan_records.hpp"

namespace clearway::tool {
namespace {

struct ExportOptions {
  std::filesystem::path result, output, trajectory;
  std::vector<std::filesystem::path> scans;
  TrajectoryOptions trajectory_options;
  LengthOptions lengths;
  std::string what = "collisions";
  double chainage_start = 0;
  bool force = false;
  bool json = false;
};

void check_combination(const ExportOptions& options) {
  if (!options.scans.empty() && options.what != "collisions") {
    throw UsageError("--scans is for the colliding points: leave out --what " + options.what);
  }
  if (options.chainage_start != 0 && options.what != "profile") {
    throw UsageError("--chainage-start counts along a profile: it needs --what profile");
  }
  if (!options.trajectory.empty() && options.what != "profile") {
    throw UsageError("--trajectory names the poses of a profile: it needs --what profile");
  }
}

/// Reads the labels of the poses from the trajectory, if one is given. Throws InputError where it
/// is not that of the result.
PoseLabels labels_for(const ResultReader& result, ExportOptions& options) {
  PoseLabels labels;
  if (options.trajectory.empty()) return labels;
  options.trajectory_options.default_crs = result.header().crs_wkt;
  std::vector<Message> remarks;
  const std::vector<Pose> poses =
      read_trajectory(options.trajectory, options.trajectory_options, &remarks, &labels);
  if (poses.size() != result.header().poses ||
      hash_of_trajectory(poses) != result.header().trajectory_hash) {
    throw InputError(options.trajectory.string() + ": has other poses than the trajectory of " +
                     result.name() + "; expected the same file and options as for the run");
  }
  return labels;
}

/// How many rows were written, and what one row is.
struct Exported {
  std::uint64_t rows;
  const char* row;
};

Exported export_table(const ResultReader& result, ExportOptions& options) {
  ConsoleProgress progress;
  if (options.what == "clearance") {
    export_clearances(result, options.output, options.force, progress);
    return {result.clearances(), "clearance"};
  }
  if (options.what == "near") {
    export_near(result, options.output, options.force, progress);
    return {result.near(), "near point"};
  }
  if (options.what == "profile") {
    options.trajectory_options.environment_unit =
        options.lengths.convert_for(options.result, result.header());
    export_profile(result, labels_for(result, options), options.chainage_start, options.output,
                   options.force, progress);
    return {result.profile_rows(), "pose"};
  }
  if (options.scans.empty()) {
    export_result(result, options.output, options.force, progress);
  } else {
    export_scan_records(result, options.scans, options.output, options.force, progress);
  }
  return {result.collisions(), "colliding point"};
}

void run_export(ExportOptions& options) {
  check_combination(options);
  std::vector<std::filesystem::path> inputs = options.scans;
  inputs.push_back(options.result);
  if (!options.trajectory.empty()) inputs.push_back(options.trajectory);
  refuse_overwriting(options.output, inputs);
  const ResultReader result(options.result);
  const Exported exported = export_table(result, options);
  spdlog::info("{}: {}", options.output.string(), counted(exported.rows, exported.row));
  repeat_warnings(result);
  const std::string verdict = verdict_to_repeat(result, {}, symbol_of(unit_of(result.header())));
  if (!verdict.empty()) spdlog::info("the verdict of this result is {}", verdict);
  if (!options.json) return;
  nlohmann::ordered_json out =
      program_json({{"result", options.result}, {"output", options.output}});
  out["what"] = options.what;
  out["with_records_of_scans"] = !options.scans.empty();
  out["rows"] = exported.rows;
  const Answer answer = counted_answer(result);
  out["verdict"] = name_of(answer.verdict());
  out["doubts"] = answer.doubts();
  out["warned_of"] = answer.warned_of();
  out["warnings"] = answer.warnings;
  out["ignored"] = ignored_json(answer);
  print(indented_text(out));
}

constexpr const char* kFooter =
    "Formats, with coordinates in the environment's unit, normally metres:\n"
    "  .las  integers, scale, offset and CRS of the scans; first_pose as extra bytes\n"
    "  .ply  binary little-endian, double x y z, uint first_pose\n"
    "  .xyz  text: x y z, and with --what clearance also distance and pose\n"
    "  .csv  text with a header: source,x,y,z,first_pose\n"
    "first_pose counts from 0 and is there where the result has it. source is the point's index\n"
    "in the order of the scans. Text has enough digits to give back each coordinate exactly.\n"
    "With --what near they are the points of an undecided run that do not collide but may in\n"
    "truth, and first_pose is the first pose that comes so close.\n"
    "With --what clearance, distance and pose take the place of first_pose.\n"
    "With --what profile it is CSV only: pose,time,name,station,chainage,distance,\n"
    "source,x,y,z.\n"
    "Of several bodies it has searched too: 0 where no body has a pose.\n"
    "With --scans it copies records of LAS, all of one point format, with all their fields.\n"
    "Example: clearway export out.h5 -o colliding.las";

}  // namespace

void add_export(CLI::App& program) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command = program.add_subcommand(
      "export", "Write the colliding points of a result as LAS, PLY, XYZ or CSV");
  add_file(*command, "RESULT", options->result, "Result of clearway run")->required();
  add_file(*command, "-o,--output", options->output,
           "Output; the ending of its name chooses the format")
      ->required();
  command
      ->add_option(
          "--what", options->what,
          "collisions; near, points that only the error budget brings too close; clearance, "
          "what run --clearance found; or profile, a line a pose")
      ->check(CLI::IsMember({"collisions", "near", "clearance", "profile"}))
      ->capture_default_str();
  command
      ->add_option("--scans", options->scans,
                   "Copy the points' own records out of these scans, as convert got them; LAS only")
      ->type_name("PATH...");
  add_file(*command, "--trajectory", options->trajectory,
           "The trajectory of the run: adds its labels, such as times, to a profile");
  add_chainage_option(*command, options->lengths, options->chainage_start);
  add_trajectory_options(*command, options->trajectory_options, options->lengths);
  command->add_flag("--force", options->force, "Overwrite an existing output");
  command->add_flag("--json", options->json, "Print one JSON object");
  command->footer(kFooter);
  command->callback([options, command] {
    run_stoppable(options->output, kStartsAgain, [&] {
      advising_to_run_again(*command, {{options->result, options->trajectory}},
                            [&] { run_export(*options); });
    });
  });
}

}  // namespace clearway::tool
