#include "cli/campaign/question_reader.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "campaign/plan.hpp"
#include "clearway/clearway.hpp"
#include "cli/input_roles.hpp"
#include "cli/steps.hpp"
#include "cli/support/console.hpp"
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
using campaign::Command;
using campaign::PlannedRun;

/// Why a command line is refused; nothing where it is not.
template <typename Options>
std::optional<CLI::ParseError> refusal_of(const Command& words, const Arguments& arguments,
                                          Options& options) {
  CLI::App command;
  add_options(command, options);
  std::vector<std::string> reversed(words.rbegin(), words.rend());
  for (const Argument& argument : arguments) reversed.insert(reversed.begin(), argument.text());
  try {
    command.parse(reversed);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    return error;
  }
}

/// Parses a command line. Throws InputError where it is refused. The key of campaign.json that this
/// names is that of the first argument up to which the command line is refused for a reason of the
/// same kind: a value that is wrong by itself, or the later one of two that exclude each other. No
/// argument is the reason where one is missing.
template <typename Options>
void parse_arguments(const std::filesystem::path& file, const Command& words,
                     const Arguments& arguments, Options& options) {
  const auto whole = refusal_of(words, arguments, options);
  if (!whole) return;
  const int kind = whole->get_exit_code();
  Arguments first;
  for (const Argument& argument : arguments) {
    if (kind == static_cast<int>(CLI::ExitCodes::RequiredError)) break;
    first.push_back(argument);
    Options unused;
    const auto refusal = refusal_of(words, first, unused);
    if (!refusal || refusal->get_exit_code() != kind) continue;
    const std::string option = argument.option + ": ";  // which the key stands for
    const std::string text = refusal->what();
    throw InputError(file.string() + ": " + argument.key + ": " +
                     (text.starts_with(option) ? text.substr(option.size()) : text));
  }
  throw InputError(file.string() + ": " + whole->what());
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
  const ReadTrajectory& path = trajectory(run, options);
  header.poses = path.count;
  header.trajectory_hash = path.hash;
  ReadModel searched =
      options.vehicle.empty() ? model(run, options) : vehicle(run, options, path.poses);
  for (ReadModel::Part& part : searched.parts) {
    header.model_points += part.points;
    header.model_triangles += part.triangles;
    if (options.vehicle.empty()) part.poses = path.poses;
  }
  header.model_hash = searched.hash;
  header.notes.model_axes = searched.axes;
  const std::uint32_t shards =
      named(run.environment.key, [&] { return shards_of(options, searched); });
  return {campaign::question_of(header), store.unit, shards, store.fingerprint};
}

void QuestionReader::parse(const PlannedRun& run, RunOptions& options) const {
  parse_arguments(file_, {"--output=" + std::string(campaign::kResultName)},
                  run.taken_by(campaign::kSearch), options);
  try {
    check_query(options.query, options.search);
  } catch (const UsageError& error) {
    throw InputError(file_.string() + ": query: " + error.what(), error.remedy(), error.amount());
  }
}

void QuestionReader::check_outputs(const PlannedRun& run) {
  for (const auto& [command, words] : run.outputs) {
    const Arguments arguments = run.taken_by(command, false);
    std::string text = words[0];
    for (const Argument& argument : arguments) text += '\n' + argument.text();
    if (!checked_.insert(text).second) continue;
    const Command options(words.begin() + 1, words.end());
    ReportCommand report;
    ConflictsCommand conflicts;
    if (command == campaign::kReport) {
      parse_arguments(file_, options, arguments, report);
    } else {
      parse_arguments(file_, options, arguments, conflicts);
    }
  }
}

/// Throws InputError for classes that a report would refuse.
void QuestionReader::check_classes(const PlannedRun& run, const RunOptions& options,
                                   double metres) const {
  const auto given = std::ranges::find(run.arguments, "--classes", &Argument::option);
  if (given == run.arguments.end()) return;
  const auto refuse_classes = [&](const std::string& what) {
    throw InputError(file_.string() + ": " + given->key + ": " + what);
  };
  std::vector<double> classes;
  const double radius = options.query.radius, clearance = options.query.clearance;
  for (const std::string& text : CLI::detail::split(given->value, ',')) {
    classes.push_back(parse_length(given->key, text).in_units_of(metres));
  }
  if (classes.size() > 3 || !std::ranges::is_sorted(classes, std::less_equal{})) {
    refuse_classes("expected one to three distances, each larger than the one before");
  }
  if (classes.back() < radius) {
    refuse_classes("the last is below the radius of " + format_number(radius));
  }
  for (const double below : classes) {
    if (below > clearance && below != radius) {
      refuse_classes(format_number(below) + ": needs a clearance as large in query");
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

QuestionReader::ReadModel QuestionReader::model(const PlannedRun& run, const RunOptions& options) {
  const ModelOptions how = named(run.vehicle.key, [&] { return model_options_of(options); });
  const std::string id =
      run.vehicle.name + '\n' + format_number(how.spacing) + '\n' + format_number(how.radius) +
      '\n' + std::to_string(static_cast<int>(how.as)) + '\n' + format_number(how.environment_unit);
  return named(run.vehicle.key, [&] {
    if (!models_.contains(id)) {
      check_is_model(options.model);
      std::vector<Message> messages;
      const Model shape = read_model(options.model, how, &messages);
      log_warnings(run.vehicle.key, messages);
      const Box box = shape.empty() ? Box{} : box_of(shape.vertices);
      models_[id] = {{{shape.vertices.size(), shape.triangles.size(), box, {}}},
                     hash_of_model(shape),
                     {how.forward, how.up},
                     {}};
    }
    if (models_[id].parts[0].triangles > 0) check_surface(options.query, options.search);
    return models_[id];
  });
}

/// Each run reads its vehicle anew, because where the bodies are depends on the route.
QuestionReader::ReadModel QuestionReader::vehicle(const PlannedRun& run, const RunOptions& options,
                                                  const std::vector<Pose>& poses) const {
  std::vector<Message> messages;
  Query query({}, poses, options.query);
  named(run.vehicle.key, [&] {
    check_vehicle_search(options.search);
    query.bodies = read_vehicle(
        options.vehicle, poses,
        {model_options_of(options), options.trajectory_options, options.search.threads}, &messages);
    check_bodies(query, options.search);
  });
  log_warnings(run.vehicle.key, messages);
  ReadModel read{{}, hash_of_bodies(query.bodies), file_axes(query), {}};
  read.bodies = std::move(query.bodies);
  for (const Body& body : read.bodies) {
    read.parts.push_back({body.model.vertices.size(), body.model.triangles.size(),
                          box_of(body.model.vertices), body.poses});
  }
  return read;
}

const QuestionReader::ReadTrajectory& QuestionReader::trajectory(const PlannedRun& run,
                                                                 const RunOptions& options) {
  const bool needs_poses = shard_seconds_ > 0 || !options.vehicle.empty();
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

/// The number of shards of a run, at least 1. The estimate is for the device that the run asks for:
/// a GPU, or the CPU with the run's threads, or with one thread where it names none.
std::uint32_t QuestionReader::shards_of(const RunOptions& run, const ReadModel& model) {
  if (shard_seconds_ == 0) return 1;
  if (!store_ || store_->path() != run.environment) store_.emplace(run.environment);
  std::vector<Workload> work;
  for (const auto& [points, triangles, box, poses] : model.parts) {
    work.push_back(
        workload_of(store_->reader(), run.query, box, points_to_search(points, triangles), poses));
  }
  const DeviceEstimate seconds = estimate_devices(work, run.query, std::max(run.search.threads, 1));
  const double needed = run.search.device == Device::kCuda ? seconds.cuda : seconds.cpu;
  return static_cast<std::uint32_t>(
      std::clamp(std::ceil(needed / shard_seconds_), 1.0, double{Shard::kMost}));
}

}  // namespace clearway::tool
