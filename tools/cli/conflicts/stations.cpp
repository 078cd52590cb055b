#include "clearway/stations.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/commands.hpp"
#include "cli/conflicts/conflict_inputs.hpp"
#include "cli/input_roles.hpp"
#include "cli/steps.hpp"
#include "cli/support/console.hpp"
#include "cli/support/options.hpp"
#include "cli/support/trajectory_options.hpp"
#include "cli/vehicle/vehicle_inputs.hpp"
#include "cli/verdict.hpp"
#include "core/geometry/point_box.hpp"
#include "core/trajectory/chainage.hpp"
#include "core/util/format.hpp"
#include "io/files/pending_file.hpp"
#include "io/result/answer.hpp"
#include "io/result/conflicts/station_file.hpp"
#include "io/result/result.hpp"

namespace clearway::tool {
namespace {

/// A length to a millimetre; values that round to 0 have no sign.
std::string cell(const std::optional<double>& metres) {
  if (!metres) return "-";
  return fmt::format("{:.3f}", std::abs(*metres) < 0.0005 ? 0 : *metres);
}

std::string cell(const std::optional<FoundPlace>& place) {
  return cell(place ? std::optional(place->distance) : std::nullopt);
}

/// The least distance, or below or above what it is, where that is all that is known.
std::string least_cell(const StationRow& row) {
  if (row.least_below) return "< " + format_brief(*row.least_below);
  if (row.least_above) return "> " + format_brief(*row.least_above);
  return cell(row.least);
}

/// Why a row is not clear, in a few words.
std::string why(const StationRow& row) {
  if (row.verdict != Verdict::kUndecided) return "";
  std::vector<std::string> words;
  for (const Reason reason : row.reasons) {
    // The codes of the doubts say more.
    if (reason != Reason::kQuestionInDoubt) words.emplace_back(name_of(reason));
  }
  words.insert(words.end(), row.doubts.begin(), row.doubts.end());
  if (!row.is_searched) words.emplace_back("not searched");
  return fmt::format(" ({})", fmt::join(words, ", "));
}

/// The greatest overthrow of all bodies.
Overthrow greatest(const StationRow& row) {
  Overthrow out;
  for (const Overthrow& body : row.overthrow) {
    out.end = std::max(out.end, body.end);
    out.middle = std::max(out.middle, body.middle);
  }
  return out;
}

std::string totals_text(const StationTable& table, const StationsCommand& options, double length,
                        const std::string& unit) {
  std::array<std::uint64_t, 4> of{};
  for (const StationRow& row : table.rows) ++of[static_cast<std::size_t>(row.verdict)];
  const auto count = [&](Verdict verdict) {
    return format_count(of[static_cast<std::size_t>(verdict)]) + " " + name_of(verdict);
  };
  return counted(table.rows.size(), "stretch", "stretches") + " of " + format_brief(options.every) +
         " " + unit + " along " + format_brief(length) + " " + unit +
         " of path: " + count(Verdict::kConflict) + ", " + count(Verdict::kUndecided) + ", " +
         count(Verdict::kClear) + "\n";
}

std::string rows_text(const StationTable& table, std::size_t most, const std::string& unit) {
  using Row = StationRow;
  return stretches_text<Row>(
      {{"least", 8, least_cell},
       {"left", 8, [](const Row& row) { return cell(row.left); }},
       {"right", 8, [](const Row& row) { return cell(row.right); }},
       {"above", 8, [](const Row& row) { return cell(row.above); }},
       {"overthrow end", 13, [](const Row& row) { return cell(greatest(row).end); }},
       {"overthrow middle", 16, [](const Row& row) { return cell(greatest(row).middle); }},
       {"verdict", 0, [](const Row& row) { return name_of(row.verdict) + why(row); }, true}},
      0, table.rows, most, unit, "stretch", "stretches");
}

StationOptions options_of(const StationsCommand& command) {
  StationOptions out;
  out.every = command.every;
  out.chainage_start = command.find.chainage_start;
  out.forward = command.find.forward;
  out.up = command.find.up;
  out.threads = command.find.threads;
  out.station = command.find.station;
  out.bodies = command.find.bodies;
  out.progress = command.find.progress;
  out.stop = command.find.stop;
  return out;
}

void add_inputs(CLI::App& command, StationsCommand& options) {
  add_result_inputs(command, options);
  add_file(command, "-o,--output", options.outputs,
           "Output: .csv or .json; may be given several times");
  add_file(command, "--vehicle", options.vehicle,
           "The vehicle of several bodies of the run: for sides and overthrow, and to know "
           "where it was searched");
  add_model_options(command, options.model_options, options.lengths);
  add_trajectory_options(command, options.trajectory_options, options.lengths);
}

}  // namespace

StationsOutcome perform(StationsCommand& command) {
  NewOutputs<StationFormat> outputs(command, station_format_of, command.with({}));
  OpenedResult opened(command, command);
  const Result& result = opened.result;
  repeat_warnings(result.reader());
  opened.read();
  opened.log_messages();
  const ResultHeader& header = result.reader().header();
  const std::vector<Pose>& poses = opened.poses;
  StationOptions options = options_of(command);
  const StationTable table = station_table(result, poses, options);
  const Answer answer = counted_answer(result.reader());
  const StationFile file{table, options, header, answer};
  outputs.write([&](StationFormat format, const std::filesystem::path& path) {
    write_stations(file, format, path);
  });
  for (const Message& warning : table.warnings) log_message(warning);
  const std::string unit = symbol_of(unit_of(header));
  return {
      totals_text(table, command, path_length(poses), unit) + rows_text(table, command.show, unit),
      "{\n" + member_lines(summary_of(file)) + "\n}\n"};
}

void add_options(CLI::App& command, StationsCommand& options) {
  add_inputs(command, options);
  options.lengths
      .add(command, "--every", options.every, "Length of a stretch along the path (default: 5)")
      ->group(title_of(OptionGroup::kConflicts));
  add_chainage_option(command, options.lengths, options.find.chainage_start);
  add_axis_options(command, options);
  {
    const GroupScope speed(command, OptionGroup::kSpeed);
    add_threads_option(command, options.find.threads);
  }
  add_count_option(command, "--show", options.show, 0, 1'000'000'000,
                   "Print a table of so many stretches");
  command.add_flag("--force", options.force, "Overwrite existing outputs");
  command.add_flag("--json", options.json, "Print one JSON object, without the stretches");
}

void add_stations(CLI::App& program) {
  const auto options = std::make_shared<StationsCommand>();
  CLI::App* command = program.add_subcommand(
      "stations", "Describe the path of a result stretch by stretch: distances and verdict");
  add_options(*command, *options);
  command->footer(
      "For each stretch: the least distance, and those to the left, to the right and above, with\n"
      "their points; how far the ends and the middle of each body leave the path in curves; and\n"
      "the verdict. Distances need a result with clearances or a profile.\n"
      "Example: clearway stations out.h5 --trajectory path.txt --every 5 -o stations.csv");
  command->callback([options, command] {
    work_on_result(*command, *options, [&] {
      const auto [text, json] = perform(*options);
      print(options->json ? json : text);
    });
  });
}

}  // namespace clearway::tool
