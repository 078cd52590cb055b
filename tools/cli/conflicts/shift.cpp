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
  std::filesystem::path environment;
  std::optional<std::array<double, 2>> lateral;
  double step = ShiftOptions{}.step;
  SessionOptions machine;
};

ShiftOptions shift_options_of(const ShiftCommand& command) {
  ShiftOptions out;
  if (command.lateral) {
    out.lateral_from = (*command.lateral)[0];
    out.lateral_to = (*command.lateral)[1];
  }
  out.step = command.step;
  out.forward = command.find.forward;
  out.up = command.find.up;
  out.chainage_start = command.find.chainage_start;
  out.station = command.find.station;
  out.progress = command.find.progress;
  out.stop = command.find.stop;
  return out;
}

/// How far was looked on either side, for example "of up to 2 m" or "between 1 m to the right and 3
/// m to the left".
std::string limits_text(const ShiftTable& table, const std::string& unit) {
  const std::string left = format_length(table.lateral_to) + " " + unit;
  const std::string right = format_length(-table.lateral_from) + " " + unit;
  if (left == right) return "of up to " + left;
  return "between " + right + " to the right and " + left + " to the left";
}

std::string shift_text(const StretchShift& row, const ShiftTable& table, const std::string& unit) {
  if (!row.shift) {
    const std::string none = "no shift " + limits_text(table, unit) + " ";
    return row.warned_of.empty()
               ? none + "frees it"
               : none + "is known to free it, because " + doubt_words(row.warned_of);
  }
  if (*row.shift == 0) return "it is free";
  const std::string text =
      format_length(std::abs(*row.shift)) + " " + unit + " to the " + side_of(row) + " frees it";
  if (row.warned_of.empty()) return text;
  return fmt::format("{}, but its place causes the {} {}", text,
                     row.warned_of.size() == 1 ? "warning" : "warnings",
                     fmt::join(row.warned_of, ", "));
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

std::string text_of(const ShiftFile& file, std::size_t most) {
  const ShiftTable& table = file.table;
  std::string text = "the whole path: " + shift_text(table.path, table, file.unit) + "\n";
  const auto freed = std::ranges::count_if(
      table.conflicts, [](const StretchShift& row) { return row.shift.has_value(); });
  text +=
      counted(table.conflicts.size(), "conflict") +
      fmt::format(", of which {} can be freed by a shift {}; {}\n", freed,
                  limits_text(table, file.unit), counted(table.searches, "search", "searches")) +
      small_text(file);
  using Row = StretchShift;
  return text + stretches_text<Row>(
                    {{"conflict", 8, [](const Row& row) { return std::to_string(row.conflict); }},
                     {"poses", 13,
                      [](const Row& row) {
                        return fmt::format("{} - {}", row.first_pose, row.last_pose);
                      }},
                     {"searches", 8, [](const Row& row) { return std::to_string(row.searches); }},
                     {"shift", 0,
                      [&](const Row& row) {
                        return shift_text(row, table, file.unit) +
                               (row.least_distance ? fmt::format(", with {:.3f} {} of room",
                                                                 *row.least_distance, file.unit)
                                                   : "");
                      },
                      true}},
                    1, table.conflicts, most, file.unit, "conflict", "conflicts");
}

/// The table in words, or in JSON.
std::string perform(ShiftCommand& options) {
  if (options.model.empty() && options.vehicle.empty()) throw CLI::RequiredError("--model");
  NewOutputs<ShiftFormat> outputs(options, shift_format_of, options.with({options.environment}));
  OpenedResult opened(options, options);
  const Result& result = opened.result;
  repeat_warnings(result.reader());
  check_is_store(options.environment);
  options.machine.threads = options.find.threads;
  options.machine.memory_bytes = options.find.memory_bytes;
  const Session session(options.environment, options.machine);
  opened.read(&session.store());
  opened.log_messages();
  Query query({}, {}, result.parameters());
  query.poses = std::move(opened.poses);
  query.model = std::move(opened.model);
  query.bodies = std::move(opened.bodies);
  options.find.model = nullptr;  // own shifts are not asked for
  const Conflicts conflicts = find_conflicts(result, query.poses, options.find);
  const ShiftTable table =
      find_shifts(session, result, query, conflicts.listed, shift_options_of(options));
  const std::string unit = symbol_of_unit(session.store().length_unit());
  const ShiftFile file{table, conflicts, options.find, result.reader(), unit};
  outputs.write([&](ShiftFormat format, const std::filesystem::path& path) {
    write_shifts(file, format, path);
  });
  spdlog::info("{} in {:.2f} s", counted(table.searches, "search", "searches"), table.seconds);
  spdlog::info(
      "what was not scanned counts as free; clearway run --seen along the shifted path shows "
      "whether it was");
  return options.json ? json_of(file) : text_of(file, options.show);
}

void add_inputs(CLI::App& command, ShiftCommand& options) {
  const GroupScope group(command, OptionGroup::kInputs);
  add_file(command, "RESULT", options.result, "Result of clearway run with --first-pose")
      ->required();
  add_file(command, "--env", options.environment, "The store that was searched")->required();
  CLI::Option* model = add_file(command, "--model", options.model, "The model that was moved");
  add_vehicle_option(command, options.vehicle,
                     "Instead of --model: the vehicle of several bodies that was moved", model);
  add_file(command, "--trajectory", options.trajectory, kTrajectoryHelp)->required();
  add_file(command, "-o,--output", options.outputs,
           "Output: .csv, or .json, which clearway report --shifts takes; may be given "
           "several times");
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
    work_on_result(*command, *options, [&] { print(perform(*options)); });
  });
}

}  // namespace clearway::tool
