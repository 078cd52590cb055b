#include "cli/conflicts/conflict_inputs.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "clearway/error.hpp"
#include "clearway/vehicle.hpp"
#include "cli/input_roles.hpp"
#include "cli/run_again.hpp"
#include "cli/support/field_options.hpp"
#include "cli/support/options.hpp"
#include "cli/support/trajectory_options.hpp"
#include "cli/vehicle/vehicle_inputs.hpp"
#include "core/describe/ledger.hpp"
#include "core/util/format.hpp"
#include "io/files/input_error.hpp"
#include "io/files/xxh64.hpp"
#include "io/paths/content_hash.hpp"
#include "io/result/result.hpp"

namespace clearway::tool {
namespace {

/// Options that read the model of a result again as it was read for the search, and turn it as its
/// run did.
ModelOptions model_options_of(const ResultHeader& header, ModelOptions options) {
  options.radius = header.radius;
  if (const double metre = metres_of(unit_of(header)); metre > 0) options.environment_unit = metre;
  options.forward = header.notes.model_axes.forward;
  options.up = header.notes.model_axes.up;
  if (header.model_solids > 0) {
    options.as = ModelAs::kSolid;
  } else if (header.model_triangles > 0) {
    options.as = ModelAs::kSurface;
  } else {
    options.as = ModelAs::kPoints;
    if (!options.asks_for_points()) options.spacing = header.notes.model_spacing;
  }
  return options;
}

Result open_result(const SearchedFiles& files) {
  check_is_trajectory(files.trajectory);
  return Result(files.result);
}

}  // namespace

void add_conflict_options(CLI::App& command, ConflictCommand& options) {
  const GroupScope group(command, OptionGroup::kConflicts);
  options.lengths.add(
      command, "--gap", options.find.gap,
      "Points at most this far apart belong together (default: 0.3, or three times the distance "
      "between colliding points where that is more)");
  add_count_option(
      command, "--min-points", options.find.min_points, 1, 1'000'000'000'000'000,
      "Groups of fewer points are counted, not listed (default: as many as lie on 10 x "
      "10 cm, at least 1 and at most 10)")
      ->default_str("");
  options.lengths.add(command, "--split", options.find.split,
                      "Cut groups that are longer than this along the path at multiples of it; 0: "
                      "never (default: 25)",
                      FieldRange::kFromZero);
  add_chainage_option(command, options.lengths, options.find.chainage_start);
  {
    const GroupScope speed(command, OptionGroup::kSpeed);
    add_memory_option(command, options.find.memory_bytes);
    add_threads_option(command, options.find.threads);
  }
}

void add_ledger_options(CLI::App& command, LedgerCommand& ledger, LengthOptions& lengths) {
  command
      .add_option("--ledger", ledger.options.table,
                  "Compare the conflicts with a ledger, a table of those that are known: which are "
                  "new, accepted, worse or gone")
      ->group(title_of(OptionGroup::kConflicts))
      ->type_name("FILE");
  add_fields(command, kLedgerFields, ledger.options, lengths);
}

void add_update_option(CLI::App& command, LedgerCommand& ledger, LengthOptions& lengths) {
  add_fields(command, kLedgerUpdateFields, ledger.options, lengths);
  command.get_option("--update")->needs("--ledger");
}

Ledger apply_ledger_of(const LedgerCommand& ledger, const GroupedResult& found,
                       const ConflictOptions& find, const Store* store) {
  LedgerOptions options = ledger.options;
  std::optional<Store> own;
  if (store == nullptr && !ledger.environment.empty()) store = &own.emplace(ledger.environment);
  options.store = store;
  options.memory_bytes = find.memory_bytes;
  options.threads = find.threads;
  options.progress = find.progress;
  options.stop = find.stop;
  return apply_ledger(found, find, options);
}

void work_on_result(const CLI::App& command, const ConflictCommand& options,
                    const std::function<void()>& work) {
  run_stoppable(options.result, kStartsAgain, [&] {
    advising_to_run_again(command, {{options.result, options.trajectory}}, work);
  });
}

void add_axis_options(CLI::App& command, ConflictCommand& options) {
  const GroupScope group(command, OptionGroup::kUnits);
  options.axes = {
      add_axis_option(command, "--forward", options.find.forward,
                      "Axis of the model that points ahead, for example +y (default: +x); not for "
                      "a result whose run turned the model"),
      add_axis_option(command, "--up", options.find.up,
                      "Axis of the model that points up, for example -z (default: +z)")};
}

void add_vehicle_option(CLI::App& command, std::filesystem::path& vehicle,
                        const std::string& description, CLI::Option* model) {
  add_file(command, "--vehicle", vehicle, description)->excludes(model);
}

std::vector<std::filesystem::path> SearchedFiles::with(
    std::vector<std::filesystem::path> others) const {
  others.insert(others.end(), {result, trajectory, model});
  return vehicle.empty() ? others : vehicle_inputs(vehicle, std::move(others));
}

void add_result_inputs(CLI::App& command, ConflictCommand& options) {
  add_file(command, "RESULT", options.result, "Result of clearway run with --first-pose")
      ->required();
  add_file(command, "--trajectory", options.trajectory, "The trajectory of the run")->required();
}

OpenedResult::OpenedResult(ConflictCommand& options, const SearchedFiles& files)
    : result(open_result(files)), options_(options), files_(files) {
  const std::string& name = result.reader().name();
  if (result.bodies().empty() && !files.vehicle.empty()) {
    throw InputError(name + ": is of one model; --vehicle is for results of several bodies");
  }
  if (!result.bodies().empty() && !files.model.empty()) {
    throw InputError(name + ": is of a vehicle of several bodies; give it with --vehicle");
  }
  const ModelAxes kept = result.model_axes();
  const bool given = std::ranges::any_of(
      options.axes, [](const CLI::Option* axis) { return axis != nullptr && !axis->empty(); });
  if (kept.need_turn() && given) {
    throw UsageError(name + ": its run turned the model by --forward " + name_of(kept.forward) +
                     " --up " + name_of(kept.up) +
                     ", and this command turns the model's file in the same way; leave out its own "
                     "--forward and --up");
  }
  options.find.progress = [this](const ProgressUpdate& update) { progress_.update(update); };
  options.find.stop = &stop_flag();
}

void OpenedResult::read(const Store* store) {
  const ResultHeader& header = result.reader().header();
  if (store != nullptr) {
    if (auto warning = options_.lengths.convert_for(*store))
      messages.push_back(std::move(*warning));
    set_environment_unit(*store, options_.trajectory_options, options_.model_options);
  } else {
    options_.model_options.environment_unit = options_.trajectory_options.environment_unit =
        options_.lengths.convert_for(files_.result, header);
  }
  options_.trajectory_options.default_crs = header.crs_wkt;
  poses = read_trajectory(files_.trajectory, options_.trajectory_options, &messages, &labels);
  messages_of_path = messages.size();
  options_.find.station = labels.station;
  const ModelOptions again = model_options_of(header, options_.model_options);
  if (!files_.model.empty()) {
    read_model_again(again);
    options_.find.model = &model;
  }
  if (!files_.vehicle.empty()) read_bodies_again(again);
  options_.find.bodies = bodies;
}

void OpenedResult::log_messages() const {
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const bool of_bodies = !bodies.empty() && messages[i].severity == Message::Severity::kWarning;
    if (i < messages_of_path || of_bodies) log_message(messages[i]);
  }
}

void OpenedResult::read_model_again(const ModelOptions& again) {
  model = read_model(files_.model, again, &messages);
  const ResultHeader& header = result.reader().header();
  const std::uint64_t hash = hash_of_model(model);
  if (model.vertices.size() == header.model_points && hash == header.model_hash) return;
  refuse(files_.model.string(), "is not the model of " + result.reader().name() + ": it has " +
                                    format_count(model.vertices.size()) + " points with the hash " +
                                    hash_text(hash) + ", expected " +
                                    format_count(header.model_points) + " with the hash " +
                                    hash_text(header.model_hash) +
                                    "; give --model the file of the run, with the same options");
}

/// The run took each body for what its file holds, or all bodies for what it was told. Only the
/// hash says which it was.
void OpenedResult::read_bodies_again(const ModelOptions& again) {
  VehicleOptions all{again, options_.trajectory_options, options_.find.threads};
  const ModelAs told = again.as;
  const auto read_as = [&](ModelAs as) {
    std::vector<Message> said;
    all.model.as = as;
    std::vector<Body> read = read_vehicle(files_.vehicle, poses, all, &said);
    return std::pair(std::move(read), std::move(said));
  };
  auto found = read_as(told == ModelAs::kPoints ? told : ModelAs::kAuto);
  const std::uint64_t hash = result.reader().header().model_hash;
  if (all.model.as != told && hash_of_bodies(found.first) != hash) {
    try {
      auto others = read_as(told);
      if (hash_of_bodies(others.first) == hash) found = std::move(others);
    } catch (const Error&) {
      // Then the vehicle is another one, which is said where the bodies are compared.
    }
  }
  bodies = std::move(found.first);
  std::ranges::move(found.second, std::back_inserter(messages));
}

std::string range_text(double from, double to) { return fmt::format("{:.2f} - {:.2f}", from, to); }

}  // namespace clearway::tool
