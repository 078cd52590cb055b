#include "clearway/convert.hpp"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "clearway/error.hpp"
#include "cli/commands.hpp"
#include "cli/steps.hpp"
#include "cli/support/console.hpp"
#include "cli/support/field_options.hpp"
#include "cli/support/lengths.hpp"
#include "cli/support/options.hpp"
#include "cli/support/program_json.hpp"
#include "cli/support/trajectory_options.hpp"
#include "core/describe/convert.hpp"
#include "core/describe/reports.hpp"
#include "core/util/format.hpp"
#include "core/util/stopwatch.hpp"
#include "io/files/facts_json.hpp"
#include "io/store/store_reader.hpp"

namespace clearway::tool {
namespace {

std::optional<double> regular_size_of(const std::string& layout) {
  const std::string regular = "regular:";
  if (layout == "adaptive") return std::nullopt;
  const std::string expected = "expected adaptive or regular:SIZE, for example regular:2";
  if (!layout.starts_with(regular)) throw UsageError("--layout " + layout + ": " + expected);
  try {
    return parse_length("--layout", layout.substr(regular.size())).value;
  } catch (const CLI::ValidationError&) {
    throw UsageError("--layout " + layout + ": " + expected + " or regular:50cm");
  }
}

/// The bytes that this process read and wrote by system calls, page cache included, as the system
/// counts them; null where it does not.
nlohmann::ordered_json bytes_moved() {
  nlohmann::ordered_json out = nullptr;
  std::ifstream io("/proc/self/io");
  for (std::string name; io >> name;) {
    std::uint64_t bytes = 0;
    if (!(io >> bytes)) break;
    if (name == "rchar:") out["read"] = bytes;
    if (name == "wchar:") out["written"] = bytes;
  }
  return out;
}

constexpr const char* kGoesOnFromThere =
    "the same command with --resume, without --force, goes on from there";

/// The report as JSON, with more about the store. What only a conversion knows is null for a store
/// that already existed.
nlohmann::ordered_json json_of(const ConvertReport& report, const ConvertCommand& options,
                               double total_seconds) {
  const StoreReader store(options.output);
  const StoreMetadata& metadata = store.metadata();
  nlohmann::ordered_json out = program_json({{"output", options.output}});
  for (const auto& input : options.inputs) out["files"]["inputs"].push_back(input.string());
  add_facts(out, report);
  if (report.was_finished) {
    for (const char* key : {"absent_points", "largest_change", "temporary_bytes", "count_seconds",
                            "distribute_seconds", "partition_seconds", "confirm_seconds"}) {
      out[key] = nullptr;
    }
  }
  out["total_seconds"] = total_seconds;
  out["near"] = metadata.near ? corridor_json(*metadata.near) : nullptr;
  out["steps"] = metadata.steps;
  out["sources"] = sources_json(metadata);
  out["origins"] = metadata.origins ? origins_json(*metadata.origins) : nullptr;
  out["busy_seconds"] = nullptr;
  for (const StageSeconds& busy : report.busy_seconds) {
    out["busy_seconds"][busy.stage] = busy.seconds;
  }
  out["bytes_moved"] = bytes_moved();
  return out;
}

/// A clause about the unit of a store that already existed, because the unit may have been given
/// only to the conversion that made it. Empty where the unit is unknown.
std::string unit_clause(const std::filesystem::path& store) {
  const LengthUnit unit = StoreReader(store).metadata().unit;
  return unit == LengthUnit::kUnknown ? "" : ", with coordinates in " + to_string(unit);
}

void log_report(const ConvertCommand& options, const ConvertReport& report) {
  if (report.was_finished) {
    spdlog::info("{}: is the store of these inputs already{}; nothing to do{}",
                 options.output.string(), unit_clause(options.output),
                 report.warnings.empty() ? "" : ". Its conversion gave the warnings above");
    return;
  }
  spdlog::info("{}: {} in {} of {}, {} ({:.2f} bytes a point)", options.output.string(),
               counted(report.points, "point"), counted(report.cells, "cell"),
               format_count(options.conversion.cell_points), format_size(report.output_bytes),
               static_cast<double>(report.output_bytes) /
                   static_cast<double>(std::max<std::uint64_t>(1, report.points)));
  if (report.far_points > 0) {
    spdlog::info("{} beyond {} of the path left out{}{}", counted(report.far_points, "point"),
                 format_number(options.conversion.within) + " m",
                 report.unread_points > 0
                     ? ", " + counted(report.unread_points, "point") + " of them not read"
                     : "",
                 report.passed_over_files > 0
                     ? "; " + counted(report.passed_over_files, "file") + " passed over by bounds"
                     : "");
  }
  if (report.largest_change > 0) {
    spdlog::info("coordinates changed by at most {:.3g} (rounded to the scale)",
                 report.largest_change);
  }
  spdlog::info(
      "seconds: count {:.2f}, distribute {:.2f}, partition {:.2f}, confirm {:.2f}; temporary {}",
      report.count_seconds, report.distribute_seconds, report.partition_seconds,
      report.confirm_seconds, format_size(report.temporary_bytes));
}

}  // namespace

ConvertReport perform(ConvertCommand& options) {
  ConvertOptions& conversion = options.conversion;
  conversion.regular_size = regular_size_of(options.layout);
  options.lengths.convert(1);  // in metres, whatever the unit of the environment
  ConsoleProgress progress;
  watch_call(conversion, progress);
  ConvertReport report = convert(options.inputs, options.output, conversion);
  log_report(options, report);
  return report;
}

void add_options(CLI::App& command, ConvertCommand& options) {
  ConvertOptions& conversion = options.conversion;
  command
      .add_option(
          "INPUT", options.inputs,
          "Scans (LAS, LAZ, E57, PLY, PCD, PTX, PTS, 3DTK, text), folders of scans, or - for LAS "
          "or LAZ on standard input")
      ->type_name("PATH")
      ->required();
  add_file(command, "-o,--output", options.output, "The store, an HDF5 file")->required();
  add_fields(command, kConvertFields, conversion, options.lengths);
  command
      .add_option("--layout", options.layout,
                  "adaptive, or regular:SIZE for cubes of that size, for example regular:50cm")
      ->group(title_of(OptionGroup::kStore))
      ->capture_default_str();
  add_options_of_reading(command, conversion.path_options, options.lengths);
  command.get_option("--resume")->excludes("--force");
  command.get_option("--near")->needs("--within");
  for (const char* of_near : {"--within", "--trust-bounds"}) {
    command.get_option(of_near)->needs("--near");
  }
  command.add_flag("--json", options.json, "Print one JSON object about the conversion");
}

void add_convert(CLI::App& program) {
  auto options = std::make_shared<ConvertCommand>();
  CLI::App* command =
      program.add_subcommand("convert", "Turn scans into a store, the one file that runs read");
  add_options(*command, *options);
  command->footer(
      "Needs temporary disk space beside the output: 20 bytes a point, 32 from standard input.\n"
      "Standard input is LAS or LAZ: clearway convert - -o site.h5 < scan.las\n"
      "Example: clearway convert scans/ -o site.h5 --memory 2G");
  command->callback([options] {
    const bool is_stream = options->inputs == std::vector<std::filesystem::path>{"-"};
    run_stoppable(options->output, is_stream ? kStartsAgain : kGoesOnFromThere, [&] {
      const Stopwatch total;
      const ConvertReport report = perform(*options);
      if (options->json) print(indented_text(json_of(report, *options, total.seconds())));
    });
  });
}

}  // namespace clearway::tool
