#include "campaign/plan.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "campaign/slurm_script.hpp"
#include "clearway/box.hpp"
#include "clearway/clearway.hpp"
#include "clearway/pose.hpp"
#include "clearway/search.hpp"
#include "clearway/store.hpp"
#include "cli/campaign/commands.hpp"
#include "cli/input_roles.hpp"
#include "cli/run_options.hpp"
#include "cli/steps.hpp"
#include "cli/support/console.hpp"
#include "cli/support/options.hpp"
#include "cli/vehicle/vehicle_inputs.hpp"
#include "core/geometry/point_box.hpp"
#include "core/query/ignored_points.hpp"
#include "core/util/format.hpp"
#include "findings/ledger/ledger_places.hpp"
#include "findings/ledger/ledger_table.hpp"
#include "io/files/file.hpp"
#include "io/files/input_error.hpp"
#include "io/files/xxh64.hpp"
#include "io/paths/content_hash.hpp"
#include "io/result/result.hpp"
#include "io/scans/length_unit.hpp"
#include "io/store/store_reader.hpp"
#include "search/check_query.hpp"
#include "search/device_estimate.hpp"
#include "search/result_header.hpp"

namespace clearway::tool {
namespace {

namespace fs = std::filesystem;
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

/// Reads the inputs of a campaign's runs as their tasks will, each environment, model and
/// trajectory once. Errors name the key of campaign.json that they come from.
class QuestionReader {
  /// Calls `call`, and rethrows its errors with file and key before the message: ResourceError as a
  /// ResourceError, all others as InputError. Interrupted passes unchanged.
  template <typename Call>
  decltype(auto) named(const std::string& key, const Call& call) const {
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

 public:
  /// shard_seconds: the time that one shard is to take, by estimate; 0 divides no run.
  QuestionReader(std::filesystem::path campaign_file, double shard_seconds)
      : file_(std::move(campaign_file)), shard_seconds_(shard_seconds) {}

  /// Throws InputError, and ResourceError where an input cannot be read.
  campaign::RunFacts facts_of(const PlannedRun& run) {
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

 private:
  struct Environment {
    ResultHeader header;           ///< the fields that describe the store
    double metres = 1;             ///< metres per unit of the store's coordinates
    bool unit_is_assumed = false;  ///< whether the store names no unit
    std::string unit, fingerprint;
  };
  /// A model, or the bodies of a vehicle.
  struct ReadModel {
    struct Part {
      std::uint64_t points = 0, triangles = 0;
      Box box{};
      std::span<const Pose> poses;
    };
    std::vector<Part> parts;
    std::uint64_t hash = 0;
    ModelAxes axes;
    std::vector<Body> bodies;  ///< hold the poses of the parts of a vehicle
  };
  struct ReadTrajectory {
    std::uint64_t count = 0, hash = 0;
    std::vector<Pose> poses{};  ///< kept only where they are needed again
  };

  void parse(const PlannedRun& run, RunOptions& options) const {
    parse_arguments(file_, {"--output=" + std::string(campaign::kResultName)},
                    run.taken_by(campaign::kSearch), options);
    try {
      check_query(options.query, options.search);
    } catch (const UsageError& error) {
      throw InputError(file_.string() + ": query: " + error.what(), error.remedy(), error.amount());
    }
  }

  void check_outputs(const PlannedRun& run) {
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
  void check_classes(const PlannedRun& run, const RunOptions& options, double metres) const {
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

  const Environment& environment(const campaign::Entry& entry) {
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

  ReadModel model(const PlannedRun& run, const RunOptions& options) {
    const ModelOptions how = named(run.vehicle.key, [&] { return model_options_of(options); });
    const std::string id = run.vehicle.name + '\n' + format_number(how.spacing) + '\n' +
                           format_number(how.radius) + '\n' +
                           std::to_string(static_cast<int>(how.as)) + '\n' +
                           format_number(how.environment_unit);
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
  ReadModel vehicle(const PlannedRun& run, const RunOptions& options,
                    const std::vector<Pose>& poses) const {
    std::vector<Message> messages;
    Query query({}, poses, options.query);
    named(run.vehicle.key, [&] {
      check_vehicle_search(options.search);
      query.bodies = read_vehicle(
          options.vehicle, poses,
          {model_options_of(options), options.trajectory_options, options.search.threads},
          &messages);
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

  const ReadTrajectory& trajectory(const PlannedRun& run, const RunOptions& options) {
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

  /// The number of shards of a run, at least 1. The estimate is for the device that the run asks
  /// for: a GPU, or the CPU with the run's threads, or with one thread where it names none.
  std::uint32_t shards_of(const RunOptions& run, const ReadModel& model) {
    if (shard_seconds_ == 0) return 1;
    if (!store_ || store_->path() != run.environment) store_.emplace(run.environment);
    std::vector<Workload> work;
    for (const auto& [points, triangles, box, poses] : model.parts) {
      work.push_back(workload_of(store_->reader(), run.query, box,
                                 points_to_search(points, triangles), poses));
    }
    const DeviceEstimate seconds =
        estimate_devices(work, run.query, std::max(run.search.threads, 1));
    const double needed = run.search.device == Device::kCuda ? seconds.cuda : seconds.cpu;
    return static_cast<std::uint32_t>(
        std::clamp(std::ceil(needed / shard_seconds_), 1.0, double{Shard::kMost}));
  }

  std::filesystem::path file_;
  double shard_seconds_;
  std::map<std::string, Environment> environments_;
  std::map<std::string, ReadModel> models_;
  std::map<std::string, ReadTrajectory> trajectories_;
  std::optional<Store> store_;     ///< that of the last run that was estimated
  std::set<std::string> checked_;  ///< the commands of outputs that were checked
};

struct CampaignPlanOptions {
  fs::path file, folder;
  bool force = false;
};

campaign::SlurmJob slurm_job(const campaign::Campaign& asked, const fs::path& folder) {
  campaign::SlurmJob job{.program = fs::read_symlink("/proc/self/exe"),
                         .folder = fs::absolute(folder).lexically_normal(),
                         .memory_bytes = SearchOptions{}.memory_bytes,
                         .threads = {},
                         .options = asked.slurm};
  for (const campaign::Argument& limit : asked.limits) {
    if (limit.option == "--memory") job.memory_bytes = parse_size(limit.option, limit.value);
    if (limit.option == "--threads") job.threads = limit.value;
    if (limit.option == "--device") job.gpu = limit.value == "cuda";
  }
  return job;
}

void make_folder(const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) throw system_failure(folder.string() + ": cannot create", failed.value());
}

void write_script(const fs::path& path, const std::string& text) {
  replace_file(path, text);
  fs::permissions(path, fs::perms::owner_exec, fs::perm_options::add);
}

/// Plans a run for each vehicle, route and radius, and shows its progress.
campaign::Plan plan_of(const campaign::Campaign& asked, const fs::path& file) {
  ConsoleProgress progress;
  const std::size_t tasks = asked.vehicles.size() * asked.routes.size() * asked.radii.size();
  progress.begin("Reading inputs", tasks, "runs");
  QuestionReader questions(file, asked.shard_seconds);
  campaign::Plan plan = campaign::make_plan(asked, [&](const campaign::PlannedRun& run) {
    if (progress.stop_requested()) throw Interrupted("");
    progress.advance(1);
    return questions.facts_of(run);
  });
  progress.end();
  return plan;
}

/// The tables of ledgers that tasks have and that do not exist yet. Throws InputError for those
/// that a task would refuse.
std::vector<fs::path> missing_ledgers(const campaign::Plan& plan) {
  std::vector<fs::path> missing;
  for (const campaign::Task& task : plan.tasks) {
    const fs::path table = task.ledger;
    std::error_code unknown;
    if (table.empty()) continue;
    if (fs::exists(table, unknown)) {
      LedgerTable(text_of_file(table), table.string());
    } else if (fs::exists(places_of(table), unknown)) {
      throw InputError(places_of(table).string() + ": is there, and its table " + table.string() +
                       " is missing; restore it, or remove the places to begin a new ledger");
    } else {
      missing.push_back(table);
    }
  }
  return missing;
}

/// Begins ledgers, so that pages can be made before the first update.
void begin_ledgers(const std::vector<fs::path>& tables) {
  for (const fs::path& table : tables) {
    make_folder(table.parent_path());
    replace_file(table, LedgerTable().text());
  }
  if (!tables.empty()) {
    spdlog::info("{} begun, such as {}", counted(tables.size(), "ledger is", "ledgers are"),
                 tables.front().string());
  }
}

void run_plan(const CampaignPlanOptions& options) {
  const campaign::Campaign asked = campaign::read_campaign(options.file);
  for (const Message& note : asked.notes) log_message(note);
  const campaign::Plan plan = plan_of(asked, options.file);
  const std::vector<fs::path> ledgers = missing_ledgers(plan);
  const std::string text = campaign::plan_text(plan);
  const fs::path planned = options.folder / campaign::kPlanName;
  std::error_code unknown;
  const bool exists = fs::exists(planned, unknown);
  const bool same = exists && text_of_file(planned) == text;
  if (exists && !same && !options.force) {
    throw UsageError(planned.string() + ": is another plan; --force replaces it. Finished runs " +
                     "of the same questions stay");
  }
  // The scripts hold what the plan does not, such as the options of sbatch.
  make_folder(options.folder / "slurm");
  const campaign::SlurmJob job = slurm_job(asked, options.folder);
  write_script(options.folder / "campaign.sbatch", campaign::sbatch_text(job, plan));
  write_script(options.folder / "submit.sh", campaign::submit_text(job, plan));
  if (same) {
    spdlog::info("{}: is this plan already; only the scripts are written", planned.string());
  } else {
    replace_file(planned, text);
  }
  begin_ledgers(ledgers);
  print(fmt::format("{}: {} ({}, {}, {})\n", asked.name, counted(plan.tasks.size(), "task"),
                    counted(asked.vehicles.size(), "vehicle"),
                    counted(asked.routes.size(), "route"),
                    counted(asked.radii.size(), "radius", "radii")));
}

}  // namespace

void add_campaign_plan(CLI::App& campaign) {
  const auto options = std::make_shared<CampaignPlanOptions>();
  CLI::App* command = campaign.add_subcommand(
      "plan", "Make a plan of tasks in a folder, and the scripts that submit it to Slurm");
  command->add_option("CAMPAIGN", options->file, "What is asked, a JSON file")
      ->type_name("FILE")
      ->required();
  command->add_option("-o,--output", options->folder, "Folder of the campaign, made if missing")
      ->type_name("DIR")
      ->required();
  command->add_flag("--force", options->force,
                    "Replace another plan; finished runs of the same questions stay");
  command->footer(
      "Reads every store's index, model and trajectory once, and refuses what a task would "
      "refuse.\n"
      "An error names the key of the JSON file. The same inputs give the same plan.\n"
      "Example: clearway campaign plan campaign.json -o spring");
  command->callback(
      [options] { run_stoppable(options->folder, kStartsAgain, [&] { run_plan(*options); }); });
}

}  // namespace clearway::tool
