#include "cli/campaign/question_reader.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <optional>
#include <vector>

#include "campaign/plan.hpp"
#include "clearway/clearway.hpp"
#include "cli/commands.hpp"
#include "cli/input_roles.hpp"
#include "cli/support/console.hpp"
#include "cli/support/options.hpp"
#include "cli/vehicle/vehicle_inputs.hpp"
#include "core/geometry/point_box.hpp"
#include "core/query/ignored_points.hpp"
#include "core/util/format.hpp"
#include "io/files/xxh64.hpp"
#include "io/paths/content_hash.hpp"
#include "io/scans/length_unit.hpp"
#include "io/store/store_reader.hpp"
#include "search/check_query.hpp"
#include "search/device_estimate.hpp"
#include "search/result_header.hpp"

namespace clearway::tool {
namespace {

using campaign::Argument;
using campaign::Arguments;
using campaign::PlannedRun;

std::vector<std::string> reversed(const campaign::Command& command, const Arguments& arguments) {
  std::vector<std::string> words;
  for (const Argument& argument : arguments) words.insert(words.begin(), argument.text);
  words.insert(words.end(), command.rbegin(), command.rend());
  return words;
}

/// Why a command line is refused.
struct Refusal {
  int kind;  ///< a value of CLI::ExitCodes
  std::string text;

  explicit Refusal(const CLI::ParseError& error)
      : kind(error.get_exit_code()), text(error.what()) {}
};

/// Parses a command line made of the first arguments, and returns why it is refused.
using Parse = std::function<std::optional<Refusal>(const Arguments&)>;

/// Throws InputError, where the command line with all of these arguments is refused as `whole`
/// says. The key of campaign.json that it names is that of the first argument up to which the
/// command line is refused for a reason of the same kind: a value that is wrong by itself, or the
/// later one of two that exclude each other. No argument is the reason where one is missing.
[[noreturn]] void refuse_argument(const std::filesystem::path& file, const Arguments& arguments,
                                  const Refusal& whole, const Parse& parse) {
  Arguments first;
  for (const Argument& argument : arguments) {
    if (whole.kind == static_cast<int>(CLI::ExitCodes::RequiredError)) break;
    first.push_back(argument);
    const std::optional<Refusal> refusal = parse(first);
    if (!refusal || refusal->kind != whole.kind) continue;
    const std::string option = argument.option + ": ";  // which the key stands for
    const std::string& text = refusal->text;
    throw InputError(file.string() + ": " + argument.key + ": " +
                     (text.starts_with(option) ? text.substr(option.size()) : text));
  }
  throw InputError(file.string() + ": " + whole.text);
}

std::string text_of(const Arguments& arguments) {
  std::string text;
  for (const Argument& argument : arguments) text += argument.text + '\n';
  return text;
}

void log_warnings(const std::string& key, const std::vector<Message>& messages) {
  for (Message message : messages) {
    if (message.severity == Message::Severity::kNote) continue;
    message.text = key + ": " + message.text;
    log_message(message);
  }
}

}  // namespace

/// Calls `call`, and rethrows its errors with file and key before the message: ResourceError as a
/// ResourceError, all others as InputError. Interrupted passes unchanged.
template <typename Call>
decltype(auto) QuestionReader::named(const std::string& key, const Call& call) const {
  const auto text = [&](const Error& error) {
    return file_.string() + ": " + key + ": " + error.what();
  };
  try {
    return call();
  } catch (const ResourceError& error) {
    throw ResourceError(text(error), error.remedy(), error.amount());
  } catch (const Interrupted&) {
    throw;
  } catch (const Error& error) {
    throw InputError(text(error), error.remedy(), error.amount());
  }
}

campaign::RunFacts QuestionReader::facts_of(const PlannedRun& run) {
  RunOptions options;
  parse(run, options);
  const Environment& store = environment(run.environment);
  check_outputs(run);
  check_classes(run, options, store.metres);
  options.lengths.convert(store.metres);
  options.model_options.environment_unit = store.metres;
  options.trajectory_options.environment_unit = store.metres;
  options.model_options.environment_unit_is_assumed = store.unit_is_assumed;
  options.trajectory_options.environment_unit_is_assumed = store.unit_is_assumed;
  options.trajectory_options.default_crs = store.header.crs_wkt;
  ResultHeader header = store.header;
  static_cast<QueryParameters&>(header) = options.query;
  sort_ignored(header);
  choose_gap(header, metre_in_units_of(store.metres));
  if (!header.ignore_classes.empty() && header.classes_hash == 0) {
    throw InputError(file_.string() + ": query.ignore_classes: the points of " +
                     run.environment.file.string() + " have no classes");
  }
  const ReadTrajectory& poses = trajectory(run, options);
  header.poses = poses.count;
  header.trajectory_hash = poses.hash;
  const std::uint32_t shards = options.vehicle.empty() ? add_model(run, options, poses, header)
                                                       : add_bodies(run, options, poses, header);
  return {campaign::question_of(header), store.unit, shards, store.fingerprint};
}

/// Adds the model of a run to `header`. Returns the number of shards.
std::uint32_t QuestionReader::add_model(const PlannedRun& run, const RunOptions& options,
                                        const ReadTrajectory& path, ResultHeader& header) {
  const ReadModel& points = model(run, options);
  if (points.triangles > 0) {
    named(run.vehicle.key, [&] { check_surface(options.query, options.search); });
  }
  header.model_points = points.count;
  header.model_triangles = points.triangles;
  header.model_hash = points.hash;
  header.notes.model_axes = {options.model_options.forward, options.model_options.up};
  const std::uint64_t estimated = points_to_search(points.count, points.triangles);
  return named(run.environment.key, [&] {
    return estimate_.shards(options, {{points.box, estimated, path.poses}});
  });
}

/// Adds the bodies of a run's vehicle to `header`. Each run reads them anew, because where they are
/// depends on the route. Returns the number of shards.
std::uint32_t QuestionReader::add_bodies(const PlannedRun& run, const RunOptions& options,
                                         const ReadTrajectory& path, ResultHeader& header) {
  std::vector<Message> messages;
  Query query({}, path.poses, options.query);
  named(run.vehicle.key, [&] {
    check_vehicle_search(options.search);
    query.bodies = read_vehicle(
        options.vehicle, path.poses,
        {model_options_of(options), options.trajectory_options, options.search.threads}, &messages);
    check_bodies(query, options.search);
  });
  log_warnings(run.vehicle.key, messages);
  std::vector<EstimatedModel> models;
  for (const Body& body : query.bodies) {
    header.model_points += body.model.vertices.size();
    header.model_triangles += body.model.triangles.size();
    models.push_back({box_of(body.model.vertices),
                      points_to_search(body.model.vertices.size(), body.model.triangles.size()),
                      body.poses});
  }
  header.model_hash = hash_of_bodies(query.bodies);
  header.notes.model_axes = file_axes(query);
  return named(run.environment.key, [&] { return estimate_.shards(options, models); });
}

void QuestionReader::parse(const PlannedRun& run, RunOptions& options) const {
  const auto parse_into = [](RunOptions& into,
                             const Arguments& arguments) -> std::optional<Refusal> {
    CLI::App command;
    add_run_options(command, into);
    try {
      command.parse(reversed({"--output=" + std::string(campaign::kResultName)}, arguments));
    } catch (const CLI::ParseError& error) {
      return Refusal(error);
    }
    return std::nullopt;
  };
  if (const auto refusal = parse_into(options, run.arguments)) {
    refuse_argument(file_, run.arguments, *refusal, [&](const Arguments& arguments) {
      RunOptions unused;
      return parse_into(unused, arguments);
    });
  }
  try {
    check_query(options.query, options.search);
  } catch (const UsageError& error) {
    throw InputError(file_.string() + ": query: " + error.what(), error.remedy(), error.amount());
  }
}

void QuestionReader::check_outputs(const PlannedRun& run) {
  for (const auto& [command, arguments] : run.outputs) {
    if (!checked_.insert(command[0] + text_of(arguments)).second) continue;
    const Parse parse = [&command = command](const Arguments& some) -> std::optional<Refusal> {
      CLI::App program;
      int exit_code = 0;
      add_conflicts(program, exit_code);
      add_report(program);
      for (CLI::App* one : program.get_subcommands({})) {
        one->parse_complete_callback([] { throw CLI::Success(); });  // parsed only, not run
      }
      try {
        program.parse(reversed(command, some));
      } catch (const CLI::Success&) {
      } catch (const CLI::ParseError& error) {
        return Refusal(error);
      }
      return std::nullopt;
    };
    if (const auto refusal = parse(arguments)) refuse_argument(file_, arguments, *refusal, parse);
  }
}

/// Throws InputError for classes that a report would refuse.
void QuestionReader::check_classes(const PlannedRun& run, const RunOptions& options,
                                   double metres) const {
  for (const auto& [command, arguments] : run.outputs) {
    for (const Argument& one : arguments) {
      if (one.option != "--classes") continue;
      const auto refused = [&](const std::string& what) {
        throw InputError(file_.string() + ": " + one.key + ": " + what);
      };
      std::vector<double> classes;
      const double radius = options.query.radius, clearance = options.query.clearance;
      for (const std::string& text :
           CLI::detail::split(one.text.substr(one.option.size() + 1), ',')) {
        const ParsedLength length = parse_length(one.key, text);
        classes.push_back(length.in_units_of(metres));
      }
      if (classes.size() > 3 || !std::ranges::is_sorted(classes, std::less_equal{})) {
        refused("expected one to three distances, each larger than the one before");
      }
      if (classes.back() < radius) {
        refused("the last is below the radius of " + format_number(radius));
      }
      for (const double below : classes) {
        if (below > clearance && below != radius) {
          refused(format_number(below) + ": needs a clearance as large in query");
        }
      }
    }
  }
}

const QuestionReader::Environment& QuestionReader::environment(const campaign::Entry& entry) {
  const auto known = environments_.find(entry.name);
  if (known != environments_.end()) return known->second;
  Environment& facts = environments_[entry.name];
  named(entry.key, [&] {
    check_is_store(entry.file);
    const Store store(entry.file);
    const StoreMetadata& metadata = store.reader().metadata();
    facts.header.environment_points = metadata.input_points;
    facts.header.environment_hash = metadata.points_hash;
    facts.header.crs_wkt = metadata.crs_wkt;
    if (metadata.classes) facts.header.classes_hash = metadata.classes->hash;
    facts.metres = store.metres_per_unit();
    facts.unit_is_assumed = store.length_unit() == "unknown";
    log_warnings(entry.key, store.warnings());
    facts.unit = symbol_of_unit(store.length_unit());
    facts.fingerprint = hash_text(store.reader().fingerprint());
  });
  return facts;
}

const QuestionReader::ReadModel& QuestionReader::model(const PlannedRun& run,
                                                       const RunOptions& options) {
  const ModelOptions how = named(run.vehicle.key, [&] { return model_options_of(options); });
  const std::string id =
      run.vehicle.name + '\n' + format_number(how.spacing) + '\n' + format_number(how.radius) +
      '\n' + std::to_string(static_cast<int>(how.as)) + '\n' + format_number(how.environment_unit);
  const auto known = models_.find(id);
  if (known != models_.end()) return known->second;
  return named(run.vehicle.key, [&]() -> const ReadModel& {
    check_is_model(options.model);
    std::vector<Message> messages;
    const Model shape = read_model(options.model, how, &messages);
    log_warnings(run.vehicle.key, messages);
    return models_[id] = {shape.vertices.size(), shape.triangles.size(), hash_of_model(shape),
                          shape.empty() ? Box{} : box_of(shape.vertices)};
  });
}

const QuestionReader::ReadTrajectory& QuestionReader::trajectory(const PlannedRun& run,
                                                                 const RunOptions& options) {
  const bool needs_poses = estimate_.is_asked_for() || !options.vehicle.empty();
  const TrajectoryOptions& how = options.trajectory_options;
  // The unit and the map that a file is read into depend on the environment.
  const std::string id =
      run.route.name + '\n' + format_number(how.environment_unit) + '\n' + how.default_crs;
  const auto known = trajectories_.find(id);
  if (known != trajectories_.end() &&
      (!needs_poses || known->second.poses.size() == known->second.count)) {
    return known->second;
  }
  return named(run.route.key, [&]() -> const ReadTrajectory& {
    check_is_trajectory(options.trajectory);
    std::vector<Message> messages;
    std::vector<Pose> poses =
        read_trajectory(options.trajectory, options.trajectory_options, &messages);
    check_has_poses(poses, options.trajectory);
    if (known == trajectories_.end()) log_warnings(run.route.key, messages);
    ReadTrajectory& read = trajectories_[id];
    read = {poses.size(), hash_of_trajectory(poses)};
    if (needs_poses) read.poses = std::move(poses);
    return read;
  });
}

}  // namespace clearway::tool
