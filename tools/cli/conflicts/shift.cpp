#include "clearway/shift.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "clearway/session.hpp"
#include "cli/commands.hpp"
#include "cli/conflicts/conflict_inputs.hpp"
#include "cli/input_roles.hpp"
#include "cli/run_again.hpp"
#include "cli/run_options.hpp"
#include "cli/support/console.hpp"
#include "cli/support/field_options.hpp"
#include "cli/support/options.hpp"
#include "cli/support/trajectory_options.hpp"
#include "cli/vehicle/vehicle_inputs.hpp"
#include "cli/verdict.hpp"
#include "core/describe/machine.hpp"
#include "core/query/verdict_words.hpp"
#include "core/util/format.hpp"
#include "io/files/pending_file.hpp"
#include "io/result/conflicts/shift_file.hpp"
#include "io/result/result.hpp"
#include "io/scans/length_unit.hpp"

namespace clearway::tool {
namespace {

/// The options of `clearway shift`.
struct ShiftCommand : ConflictCommand {
  std::filesystem::path result, environment, trajectory, model, vehicle;
  std::vector<std::filesystem::path> outputs;
  ModelOptions model_options;
  std::optional<std::array<double, 2>> lateral;
  double step = ShiftOptions{}.step;
  SessionOptions machine;
  std::uint64_t show = 20;
  bool force = false;
  bool json = false;
};

/// An output that does not exist yet.
struct ShiftOutput {
  ShiftOutput(const std::filesystem::path& path, bool overwrite)
      : format(shift_format_of(path)), pending(path, overwrite) {}

  ShiftFormat format;
  PendingFile pending;
};

std::vector<std::unique_ptr<ShiftOutput>> open_outputs(const ShiftCommand& options) {
  std::vector<std::unique_ptr<ShiftOutput>> out;
  for (const std::filesystem::path& path : options.outputs) shift_format_of(path);
  std::vector<std::filesystem::path> inputs{options.result, options.environment, options.trajectory,
                                            options.model};
  if (!options.vehicle.empty()) inputs = vehicle_inputs(options.vehicle, std::move(inputs));
  for (const std::filesystem::path& path : options.outputs) {
    refuse_overwriting(path, inputs);
    out.push_back(std::make_unique<ShiftOutput>(path, options.force));
  }
  return out;
}

/// The question of the result, from the files that were searched.
Query read_query_again(ShiftCommand& options, const Result& result, PoseLabels& labels) {
  Query query({}, {}, result.parameters());
  query.poses = read_poses(options.trajectory, options.trajectory_options, result, &labels);
  if (options.vehicle.empty()) {
    query.model = read_model_of(options.model, options.model_options, result);
    return query;
  }
  std::vector<Message> messages;
  query.bodies = read_bodies_of(options.vehicle, options.model_options, options, query.poses,
                                result, messages);
  for (const Message& message : messages) {
    if (message.severity == Message::Severity::kWarning) log_message(message);
  }
  return query;
}

ShiftOptions shift_options_of(const ShiftCommand& command, const PoseLabels& labels) {
  ShiftOptions out;
  if (command.lateral) {
    out.lateral_from = (*command.lateral)[0];
    out.lateral_to = (*command.lateral)[1];
  }
  out.step = command.step;
  out.forward = command.find.forward;
  out.up = command.find.up;
  out.chainage_start = command.find.chainage_start;
  out.station = labels.station;
  out.progress = command.find.progress;
  out.stop = command.find.stop;
  return out;
}

/// How far was looked on either side, for example "of up to 2 m" or "between 1 m to the right and 3
/// m to the left".
std::string range_text(const ShiftTable& table, const std::string& unit) {
  const std::string left = format_length(table.lateral_to) + " " + unit;
  const std::string right = format_length(-table.lateral_from) + " " + unit;
  if (left == right) return "of up to " + left;
  return "between " + right + " to the right and " + left + " to the left";
}

std::string shift_text(const StretchShift& row, const ShiftTable& table, const std::string& unit) {
  if (!row.shift) {
    const std::string none = "no shift " + range_text(table, unit) + " ";
    return row.warned_of.empty()
               ? none + "frees it"
               : none + "is known to free it, because " + doubt_words(row.warned_of);
  }
  if (*row.shift == 0) return "it is free";
  const std::string text =
      format_length(std::abs(*row.shift)) + " " + unit + " to the " + side_of(row) + " frees it";
  if (row.warned_of.empty()) return text;
  std::string codes;
  for (const std::string& code : row.warned_of) codes += (codes.empty() ? "" : ", ") + code;
  return text + ", but its place causes the " +
         (row.warned_of.size() == 1 ? "warning " : "warnings ") + codes;
}

std::string row_text(const StretchShift& row, const ShiftTable& table, const std::string& unit) {
  std::string text =
      fmt::format("{:>8}  {:>19}", row.conflict,
                  fmt::format("{:.2f} - {:.2f}", row.chainage_from, row.chainage_to));
  if (row.station_from && row.station_to) {
    text +=
        fmt::format("  {:>23}", fmt::format("{:.2f} - {:.2f}", *row.station_from, *row.station_to));
  }
  text += fmt::format("  {:>13}  {:>8}  ", fmt::format("{} - {}", row.first_pose, row.last_pose),
                      row.searches);
  return text + shift_text(row, table, unit) +
         (row.least_distance ? fmt::format(", with {:.3f} {} of room", *row.least_distance, unit)
                             : "") +
         "\n";
}

/// A line about the groups that are too small to be conflicts; none where there are none.
std::string small_text(const ShiftFile& file) {
  const Conflicts& found = file.conflicts;
  if (found.small_groups == 0) return "";
  return counted(found.small_groups, "group") + " of fewer than " +
         counted(file.conflicts.min_points, "point") + (found.small_groups == 1 ? " is" : " are") +
         " no conflict, and " + (found.small_groups == 1 ? "counts" : "count") +
         " for the whole path alone; --min-points 1 lists " +
         (found.small_groups == 1 ? "it" : "them") + "\n";
}

std::string table_text(const ShiftFile& file, std::size_t most) {
  const ShiftTable& table = file.table;
  std::string text = "the whole path: " + shift_text(table.path, table, file.unit) + "\n";
  const auto freed = std::ranges::count_if(
      table.conflicts, [](const StretchShift& row) { return row.shift.has_value(); });
  text += counted(table.conflicts.size(), "conflict") +
          fmt::format(", of which {} can be freed by a shift {}; {}\n", freed,
                      range_text(table, file.unit), counted(table.searches, "search", "searches")) +
          small_text(file);
  const std::size_t shown = std::min(most, table.conflicts.size());
  if (shown == 0) return text;
  text += fmt::format("{:>8}  {:>19}", "conflict", "chainage (" + file.unit + ")");
  if (table.conflicts.front().station_from) text += fmt::format("  {:>23}", "station (m)");
  text += fmt::format("  {:>13}  {:>8}  shift\n", "poses", "searches");
  for (const StretchShift& row : std::span(table.conflicts).first(shown)) {
    text += row_text(row, table, file.unit);
  }
  if (shown < table.conflicts.size()) {
    text += "and " + counted(table.conflicts.size() - shown, "conflict") +
            " more, which --show or an output shows\n";
  }
  return text;
}

/// The table in words, or in JSON.
std::string perform(ShiftCommand& options) {
  if (options.model.empty() && options.vehicle.empty()) throw CLI::RequiredError("--model");
  const auto outputs = open_outputs(options);
  check_is_trajectory(options.trajectory);
  const Result result(options.result);
  repeat_warnings(result.reader());
  check_kind_of_model(result, options.model, options.vehicle);
  check_axes(result, options);
  check_is_store(options.environment);
  options.machine.threads = options.find.threads;
  options.machine.memory_bytes = options.find.memory_bytes;
  const Session session(options.environment, options.machine);
  if (const auto warning = options.lengths.convert_for(session.store())) log_message(*warning);
  set_environment_unit(session.store(), options.trajectory_options, options.model_options);
  ConsoleProgress progress;
  options.find.progress = [&progress](const ProgressUpdate& update) { progress.update(update); };
  options.find.stop = &stop_flag();
  PoseLabels labels;
  const Query query = read_query_again(options, result, labels);
  options.find.station = labels.station;
  options.find.bodies = query.bodies;
  const Conflicts conflicts = find_conflicts(result, query.poses, options.find);
  const ShiftTable table =
      find_shifts(session, result, query, conflicts.listed, shift_options_of(options, labels));
  const std::string unit = symbol_of_unit(session.store().length_unit());
  const ShiftFile file{table, conflicts, options.find, result.reader(), unit};
  for (const auto& output : outputs) {
    write_shifts(file, output->format, output->pending.partial());
  }
  for (const auto& output : outputs) output->pending.publish();
  spdlog::info("{} in {:.2f} s", counted(table.searches, "search", "searches"), table.seconds);
  spdlog::info(
      "what was not scanned counts as free; clearway run --seen along the shifted path shows "
      "whether it was");
  return options.json ? json_of(file) : table_text(file, options.show);
}

void add_inputs(CLI::App& command, ShiftCommand& options) {
  const GroupScope group(command, OptionGroup::kInputs);
  add_searched_inputs(command, "Result of clearway run with --first-pose", options.result,
                      options.environment, options.model, options.vehicle, options.trajectory);
  command
      .add_option("-o,--output", options.outputs,
                  "Output: .csv, or .json, which clearway report --shifts takes; may be given "
                  "several times")
      ->type_name("FILE");
}

void add_options(CLI::App& command, ShiftCommand& options) {
  add_inputs(command, options);
  {
    const GroupScope group(command, OptionGroup::kQuestion);
    options.lengths
        .add(command, "--lateral", options.lateral,
             "The shifts that are tried: from the right, below 0, to the left, above 0 (default: "
             "-2,2)")
        ->type_name("FROM,TO");
    options.lengths.add(command, "--step", options.step,
                        "Shifts are multiples of this (default: 0.01)");
  }
  add_model_options(command, options.model_options, options.lengths);
  add_conflict_options(command, options);
  add_trajectory_options(command, options.trajectory_options, options.lengths);
  add_axis_options(command, options);
  add_fields(command, kDeviceFields<SessionOptions>, options.machine, options.lengths);
  add_count_option(command, "--show", options.show, 0, 1'000'000'000,
                   "Print a table of so many conflicts");
  command.add_flag("--force", options.force, "Overwrite existing outputs");
  command.add_flag("--json", options.json, "Print one JSON object");
}

}  // namespace

void add_shift(CLI::App& program) {
  const auto options = std::make_shared<ShiftCommand>();
  CLI::App* command = program.add_subcommand(
      "shift", "Find the least lateral shift that frees the path, and each conflict of it");
  add_options(*command, *options);
  command->footer(
      "A shift moves the vehicle along the y axis of the path's poses, to the left or to the\n"
      "right. It frees a conflict where nothing at all collides at the shifted poses from its\n"
      "first to its last touch; a search confirms that. The first row of a CSV file, with the\n"
      "conflict 0, is the whole path. With an error budget, nothing may be nearer than the\n"
      "margin and the errors.\n"
      "Example: clearway shift out.h5 --env site.h5 --model car.ply --trajectory path.txt "
      "--lateral -2,2 --step 0.01 -o shifts.json");
  command->callback([options, command] {
    run_stoppable(options->result, kStartsAgain, [&] {
      advising_to_run_again(*command, {{options->result, options->trajectory}},
                            [&] { print(perform(*options)); });
    });
  });
}

}  // namespace clearway::tool
