#include "cli/conflicts/conflict_inputs.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "clearway/error.hpp"
#include "clearway/vehicle.hpp"
#include "cli/support/console.hpp"
#include "cli/support/field_options.hpp"
#include "cli/support/options.hpp"
#include "cli/support/trajectory_options.hpp"
#include "core/describe/ledger.hpp"
#include "core/util/format.hpp"
#include "io/files/input_error.hpp"
#include "io/files/xxh64.hpp"
#include "io/paths/content_hash.hpp"
#include "io/result/result.hpp"

namespace clearway::tool {
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

void add_axis_options(CLI::App& command, ConflictCommand& options) {
  const GroupScope group(command, OptionGroup::kUnits);
  options.axes = {
      add_axis_option(command, "--forward", options.find.forward,
                      "Axis of the model that points ahead, for example +y (default: +x); not for "
                      "a result whose run turned the model"),
      add_axis_option(command, "--up", options.find.up,
                      "Axis of the model that points up, for example -z (default: +z)")};
}

void check_axes(const Result& result, const ConflictCommand& options) {
  const ModelAxes kept = result.model_axes();
  const bool given = std::ranges::any_of(
      options.axes, [](const CLI::Option* axis) { return axis != nullptr && !axis->empty(); });
  if (!kept.need_turn() || !given) return;
  throw UsageError(result.reader().name() + ": its run turned the model by --forward " +
                   name_of(kept.forward) + " --up " + name_of(kept.up) +
                   ", and this command turns the model's file in the same way; leave out its own "
                   "--forward and --up");
}

void add_vehicle_option(CLI::App& command, std::filesystem::path& vehicle,
                        const std::string& description, CLI::Option* model) {
  command.add_option("--vehicle", vehicle, description)->type_name("FILE")->excludes(model);
}

void add_searched_inputs(CLI::App& command, const std::string& about_result,
                         std::filesystem::path& result, std::filesystem::path& environment,
                         std::filesystem::path& model, std::filesystem::path& vehicle,
                         std::filesystem::path& trajectory) {
  command.add_option("RESULT", result, about_result)->type_name("FILE")->required();
  command.add_option("--env", environment, "The store that was searched")
      ->type_name("FILE")
      ->required();
  CLI::Option* of_model =
      command.add_option("--model", model, "The model that was moved")->type_name("FILE");
  add_vehicle_option(command, vehicle,
                     "Instead of --model: the vehicle of several bodies that was moved", of_model);
  command.add_option("--trajectory", trajectory, kTrajectoryHelp)->type_name("FILE")->required();
}

std::vector<Pose> read_poses(const std::filesystem::path& path, TrajectoryOptions options,
                             const Result& result, PoseLabels* labels) {
  options.default_crs = result.reader().header().crs_wkt;
  std::vector<Message> remarks;
  std::vector<Pose> poses = read_trajectory(path, options, &remarks, labels);
  for (const Message& remark : remarks) log_message(remark);
  return poses;
}

ModelOptions model_options_of(const Result& result, ModelOptions options) {
  const ResultHeader& header = result.reader().header();
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

void check_kind_of_model(const Result& result, const std::filesystem::path& model,
                         const std::filesystem::path& vehicle) {
  const std::string& name = result.reader().name();
  if (result.bodies().empty() && !vehicle.empty()) {
    throw InputError(name + ": is of one model; give it with --model");
  }
  if (!result.bodies().empty() && !model.empty()) {
    throw InputError(name + ": is of a vehicle of several bodies; give it with --vehicle");
  }
}

std::vector<Body> read_bodies_of(const std::filesystem::path& vehicle, const ModelOptions& model,
                                 const ConflictCommand& options, const std::vector<Pose>& path,
                                 const Result& result, std::vector<Message>& warnings) {
  VehicleOptions all{model_options_of(result, model), options.trajectory_options,
                     options.find.threads};
  all.trajectory.default_crs = result.reader().header().crs_wkt;
  // The run took each body for what its file holds, or all bodies for what it was told. Only the
  // hash says which it was.
  const ModelAs told = all.model.as;
  std::vector<Message> of_auto;
  all.model.as = told == ModelAs::kPoints ? told : ModelAs::kAuto;
  std::vector<Body> bodies = read_vehicle(vehicle, path, all, &of_auto);
  if (all.model.as != told && hash_of_bodies(bodies) != result.reader().header().model_hash) {
    try {
      all.model.as = told;
      std::vector<Message> of_told;
      std::vector<Body> others = read_vehicle(vehicle, path, all, &of_told);
      if (hash_of_bodies(others) == result.reader().header().model_hash) {
        bodies = std::move(others);
        of_auto = std::move(of_told);
      }
    } catch (const Error&) {
      // Then the vehicle is another one, which is said where the bodies are compared.
    }
  }
  std::ranges::move(of_auto, std::back_inserter(warnings));
  return bodies;
}

Model read_model_of(const std::filesystem::path& path, const ModelOptions& options,
                    const Result& result) {
  Model shape = read_model(path, model_options_of(result, options));
  const ResultHeader& header = result.reader().header();
  const std::uint64_t hash = hash_of_model(shape);
  if (shape.vertices.size() == header.model_points && hash == header.model_hash) return shape;
  refuse(path.string(), "is not the model of " + result.reader().name() + ": it has " +
                            format_count(shape.vertices.size()) + " points with the hash " +
                            hash_text(hash) + ", expected " + format_count(header.model_points) +
                            " with the hash " + hash_text(header.model_hash) +
                            "; give the file of the run, with the same options");
}

}  // namespace clearway::tool
