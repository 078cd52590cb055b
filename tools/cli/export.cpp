#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "cli/commands.hpp"
#include "cli/support/console.hpp"
#include "cli/support/options.hpp"
#include "cli/support/signals.hpp"
#include "core/util/format.hpp"
#include "io/export/export_result.hpp"

namespace clearway::tool {
namespace {

struct ExportOptions {
  std::filesystem::path result, output;
  std::string what = "collisions";
  bool force = false;
};

void export_rows(const ExportOptions& options) {
  const ResultReader result(options.result);
  ConsoleProgress progress;
  if (options.what == "clearance") {
    export_clearances(result, options.output, options.force, progress);
    spdlog::info("{}: {} clearances", options.output.string(), format_count(result.clearances()));
    return;
  }
  export_result(result, options.output, options.force, progress);
  spdlog::info("{}: {} colliding points", options.output.string(),
               format_count(result.collisions()));
}

}  // namespace

void add_export(CLI::App& program) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command = program.add_subcommand(
      "export", "Write the colliding points of a result as LAS, PLY, XYZ or CSV");
  command->add_option("RESULT", options->result, "Result of clearway run")
      ->type_name("FILE")
      ->required();
  command
      ->add_option("-o,--output", options->output,
                   "Output; the ending of its name chooses the format")
      ->type_name("FILE")
      ->required();
  command
      ->add_option("--what", options->what,
                   "collisions, or clearance: CSV of what run --clearance found")
      ->check(CLI::IsMember({"collisions", "clearance"}))
      ->capture_default_str();
  command->add_flag("--force", options->force, "Overwrite an existing output");
  command->footer(
      "Formats, with coordinates in the environment's unit, normally metres:\n"
      "  .las  integers, scale, offset and CRS of the scans; first_pose as extra bytes\n"
      "  .ply  binary little-endian, double x y z, uint first_pose\n"
      "  .xyz  text: x y z\n"
      "  .csv  text with a header: source,x,y,z,first_pose\n"
      "        with --what clearance: source,distance,pose\n"
      "first_pose counts from 0 and is there where the result has it. source is the point's "
      "index\n"
      "in the order of the scans. Text has enough digits to give back each coordinate exactly.\n"
      "Example: clearway export out.h5 -o colliding.las");
  command->callback(
      [options] { run_stoppable(options->output, kStartsAgain, [&] { export_rows(*options); }); });
}

}  // namespace clearway::tool
