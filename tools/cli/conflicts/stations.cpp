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
#include "cli/run_again.hpp"
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

/// An output that does not exist yet.
struct StationOutput {
  StationOutput(const std::filesystem::path& path, bool overwrite)
      : format(station_format_of(path)), pending(path, overwrite) {}

  StationFormat format;
  PendingFile pending;
};

std::vector<std::unique_ptr<StationOutput>> open_outputs(const StationsCommand& options) {
  std::vector<std::unique_ptr<StationOutput>> out;
  for (const std::filesystem::path& path : options.outputs) station_format_of(path);
  std::vector<std::filesystem::path> inputs{options.result, options.trajectory};
  if (!options.vehicle.empty()) inputs = vehicle_inputs(options.vehicle, std::move(inputs));
  for (const std::filesystem::path& path : options.outputs) {
    refuse_overwriting(path, inputs);
    out.push_back(std::make_unique<StationOutput>(path, options.force));
  }
  return out;
}

/// A length to a millimetre; values that round to 0 have no sign.
std::string cell(const std::optional<double>& metres, int width = 8) {
  if (!metres) return fmt::format("  {:>{}}", "-", width);
  const double shown = std::abs(*metres) < 0.0005 ? 0 : *metres;
  return fmt::format("  {:>{}.3f}", shown, width);
}

std::string cell(const std::optional<FoundPlace>& place) {
  return cell(place ? std::optional(place->distance) : std::nullopt);
}

/// The least distance, or below or above what it is, where that is all that is known.
std::string least_cell(const StationRow& row) {
  if (row.least_below) return fmt::format("  {:>8}", "< " + format_brief(*row.least_below));
  if (row.least_above) return fmt::format("  {:>8}", "> " + format_brief(*row.least_above));
  return cell(row.least);
}

std::string range_text(double from, double to) { return fmt::format("{:.2f} - {:.2f}", from, to); }

/// Why a row is not clear, in a few words.
std::string why(const StationRow& row) {
  if (row.verdict != Verdict::kUndecided) return "";
  std::string out;
  for (const Reason reason : row.reasons) {
    if (reason == Reason::kQuestionInDoubt) continue;  // the codes of the doubts say more
    out += (out.empty() ? " (" : ", ") + std::string(name_of(reason));
  }
  for (const std::string& code : row.doubts) out += (out.empty() ? " (" : ", ") + code;
  if (!row.is_searched) out += (out.empty() ? " (" : ", ") + std::string("not searched");
  return out + ")";
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

std::string row_text(const StationRow& row) {
  std::string text = fmt::format("{:>19}", range_text(row.chainage_from, row.chainage_to));
  if (row.station_from) {
    text += fmt::format("  {:>23}", range_text(*row.station_from, *row.station_to));
  }
  text += least_cell(row);
  for (const auto* place : {&row.left, &row.right, &row.above}) text += cell(*place);
  const Overthrow overthrow = greatest(row);
  text += cell(overthrow.end, 13) + cell(overthrow.middle, 16);
  return text + "  " + name_of(row.verdict) + why(row) + "\n";
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

/// The first `most` rows as a table.
std::string table_text(const StationTable& table, std::size_t most, const std::string& unit) {
  if (table.rows.empty() || most == 0) return "";
  std::string text = fmt::format("{:>19}", "chainage (" + unit + ")");
  if (table.rows.front().station_from) text += fmt::format("  {:>23}", "station (m)");
  for (const char* name : {"least", "left", "right", "above"}) {
    text += fmt::format("  {:>8}", name);
  }
  text += "  overthrow end  overthrow middle  verdict\n";
  const std::size_t shown = std::min(most, table.rows.size());
  for (std::size_t i = 0; i < shown; ++i) text += row_text(table.rows[i]);
  if (shown < table.rows.size()) {
    text += "and " + counted(table.rows.size() - shown, "stretch", "stretches") +
            " more, which --show or an output shows\n";
  }
  return text;
}

StationOptions options_of(const StationsCommand& command) {
  StationOptions out;
  out.every = command.every;
  out.chainage_start = command.find.chainage_start;
  out.forward = command.find.forward;
  out.up = command.find.up;
  out.threads = command.find.threads;
  out.progress = command.find.progress;
  out.stop = command.find.stop;
  return out;
}

void add_inputs(CLI::App& command, StationsCommand& options) {
  command.add_option("RESULT", options.result, "Result of clearway run with --first-pose")
      ->type_name("FILE")
      ->required();
  command.add_option("--trajectory", options.trajectory, "The trajectory of the run")
      ->type_name("FILE")
      ->required();
  command
      .add_option("-o,--output", options.outputs,
                  "Output: .csv or .json; may be given several times")
      ->type_name("FILE");
  command
      .add_option("--vehicle", options.vehicle,
                  "The vehicle of several bodies of the run: for sides and overthrow, and to know "
                  "where it was searched")
      ->type_name("FILE");
  add_model_options(command, options.model_options, options.lengths);
  add_trajectory_options(command, options.trajectory_options, options.lengths);
}

}  // namespace

StationsOutcome perform(StationsCommand& command) {
  const auto outputs = open_outputs(command);
  check_is_trajectory(command.trajectory);
  const Result result(command.result);
  repeat_warnings(result.reader());
  if (!command.vehicle.empty() && result.bodies().empty()) {
    throw InputError(command.result.string() + ": is of one model; leave out --vehicle");
  }
  check_axes(result, command);
  const ResultHeader& header = result.reader().header();
  const double metre = command.lengths.convert_for(command.result, header);
  command.trajectory_options.environment_unit = metre;
  command.model_options.environment_unit = metre;
  ConsoleProgress progress;
  command.find.progress = [&progress](const ProgressUpdate& update) { progress.update(update); };
  command.find.stop = &stop_flag();
  PoseLabels labels;
  const std::vector<Pose> poses =
      read_poses(command.trajectory, command.trajectory_options, result, &labels);
  StationOptions options = options_of(command);
  options.station = labels.station;
  std::vector<Body> bodies;
  if (!command.vehicle.empty()) {
    std::vector<Message> messages;
    bodies =
        read_bodies_of(command.vehicle, command.model_options, command, poses, result, messages);
    for (const Message& message : messages) {
      if (message.severity == Message::Severity::kWarning) log_message(message);
    }
  }
  options.bodies = bodies;
  const StationTable table = station_table(result, poses, options);
  const Answer answer = counted_answer(result.reader());
  const StationFile file{table, options, header, answer};
  for (const auto& output : outputs) {
    write_stations(file, output->format, output->pending.partial());
  }
  for (const auto& output : outputs) output->pending.publish();
  for (const Message& warning : table.warnings) log_message(warning);
  const std::string unit = symbol_of(unit_of(header));
  return {
      totals_text(table, command, path_length(poses), unit) + table_text(table, command.show, unit),
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
    run_stoppable(options->result, kStartsAgain, [&] {
      advising_to_run_again(*command, {{options->result, options->trajectory}}, [&] {
        const auto [text, json] = perform(*options);
        print(options->json ? json : text);
      });
    });
  });
}

}  // namespace clearway::tool
