#include "campaign/plan.hpp"

#include <span>

#include "campaign/question.hpp"
#include "io/system/xxh64.hpp"

namespace clearway::campaign {
namespace {

std::string id_of(const nlohmann::ordered_json& value) {
  const std::string text = value.dump();
  return hash_text(xxh64(std::as_bytes(std::span(text))));
}

Command& operator+=(Command& command, const Arguments& arguments) {
  for (const Argument& argument : arguments) command.push_back(argument.text);
  return command;
}

Arguments operator+(Arguments a, const Arguments& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Argument file_argument(const Entry& entry, const char* option) {
  return {entry.key, option, option + ("=" + entry.file.string())};
}

/// The command lines of one run, without limits.
class RunCommands {
 public:
  RunCommands(const Campaign& campaign, const Vehicle& vehicle, const Route& route,
              const Argument& radius)
      : campaign_(campaign),
        vehicle_(vehicle),
        route_(route),
        environment_(campaign.environments[route.environment]),
        model_(Arguments{file_argument(vehicle, vehicle.has_bodies() ? "--vehicle" : "--model")} +
               vehicle.arguments),
        path_(Arguments{file_argument(route, "--trajectory")} + route.arguments),
        radius_(radius) {}

  Arguments run() const {
    return Arguments{file_argument(environment_, "--env")} + model_ + vehicle_.kind + path_ +
           Arguments{radius_} + campaign_.query;
  }

  std::vector<std::pair<Command, Arguments>> outputs() const {
    std::vector<std::pair<Command, Arguments>> out;
    if (!campaign_.conflict_formats.empty()) out.push_back(conflicts());
    if (campaign_.report) {
      const std::string title = campaign_.name + ": " + vehicle_.name + " on " + route_.name;
      out.emplace_back(Command{"report", kResultName, "--force",
                               std::string("--output=") + kReportName, "--title=" + title},
                       Arguments{file_argument(environment_, "--env")} + model_ + path_ +
                           vehicle_.axes + route_.chainage + campaign_.conflicts +
                           campaign_.classes);
    }
    return out;
  }

  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const std::string& format : campaign_.conflict_formats) {
      names.push_back("conflicts." + format);
    }
    if (campaign_.report) names.emplace_back(kReportName);
    return names;
  }

 private:
  /// The command that finds the conflicts. It needs the model where pictures show it or where sides
  /// are seen from bodies; otherwise the trajectory is enough.
  std::pair<Command, Arguments> conflicts() const {
    Command command{"conflicts", kResultName, "--force", "--show=0"};
    bool needs_model = vehicle_.has_bodies();
    for (const std::string& format : campaign_.conflict_formats) {
      command.push_back("--output=conflicts." + format);
      needs_model = needs_model || format == "bcf";
    }
    return {std::move(command), path_ + (needs_model ? model_ : Arguments{}) + vehicle_.axes +
                                    route_.chainage + campaign_.conflicts};
  }

  const Campaign& campaign_;
  const Vehicle& vehicle_;
  const Route& route_;
  const Entry& environment_;
  Arguments model_, path_;
  const Argument& radius_;
};

Command with_arguments(Command command, const Arguments& arguments, const Arguments& limits) {
  command += arguments;
  command += limits;
  return command;
}

/// The words that `clearway run` begins with, for a run or for a shard.
Command run_words(const Task& task) {
  Command words{"run", "--resume", "--json", std::string("--output=") + task.result()};
  if (task.shard) words.push_back("--shard=" + to_string(*task.shard));
  return words;
}

/// The command that merges the shards. limits: "--memory" and "--threads".
Command merge_words(const Task& task, const Arguments& limits) {
  Command words{"merge", "--resume", std::string("--output=") + task.result()};
  for (std::uint32_t number = 1; number <= task.shards; ++number) {
    words.push_back("shards/" + std::to_string(number) + "/" + kPartName);
  }
  words += limits;
  return words;
}

/// The options of `clearway run` after a merge: it finds its result, says what is in it, and
/// searches nothing, so it needs no GPU.
Arguments without_search(const Campaign& campaign, const RunCommands& commands) {
  return commands.run() + Arguments{{"limits.device", "--device", "--device=cpu"}} +
         campaign.limits;
}

Task make_task(const Campaign& campaign, const RunCommands& commands, const PlannedRun& run,
               const RunFacts& facts) {
  Task task;
  task.question = facts.question;
  task.unit = facts.unit;
  task.shards = facts.shards > 1 ? facts.shards : 0;
  auto made = nlohmann::ordered_json::array();
  if (task.shards > 0) {
    task.store = facts.store;
    task.commands.push_back(merge_words(task, campaign.limits));
  }
  const bool searches = task.shards == 0;
  task.commands.push_back(with_arguments(
      run_words(task), searches ? run.arguments : without_search(campaign, commands), {}));
  for (const auto& [command, arguments] : run.outputs) {
    made.push_back(with_arguments(command, arguments, {}));
    task.commands.push_back(with_arguments(command, arguments, campaign.limits));
  }
  task.outputs_id = id_of(made);
  return task;
}

void add_tasks(Task task, const PlannedRun& run, Plan& plan) {
  for (std::uint32_t number = 1; number <= task.shards; ++number) {
    Task shard = shard_of(task, number);
    shard.number = plan.tasks.size();
    shard.commands.push_back(with_arguments(run_words(shard), run.arguments, {}));
    plan.tasks.push_back(std::move(shard));
  }
  task.number = plan.tasks.size();
  plan.tasks.push_back(std::move(task));
}

}  // namespace

std::string Task::question_id() const { return id_of(question); }

Task shard_of(const Task& merge, std::uint32_t number) {
  Task shard;
  shard.vehicle = merge.vehicle;
  shard.route = merge.route;
  shard.environment = merge.environment;
  shard.radius = merge.radius;
  shard.unit = merge.unit;
  shard.shard = Shard{number, merge.shards};
  shard.question = merge.question;
  ask_for_part(*shard.shard, merge.store, shard.question);
  shard.outputs_id = id_of(nlohmann::ordered_json::array());
  return shard;
}

Task run_of(const Task& shard) {
  Task run;
  run.vehicle = shard.vehicle;
  run.route = shard.route;
  run.environment = shard.environment;
  run.radius = shard.radius;
  run.unit = shard.unit;
  run.question = shard.question;
  run.question.erase("shard");
  run.question.erase("store");
  return run;
}

Plan make_plan(const Campaign& campaign,
               const std::function<RunFacts(const PlannedRun&)>& facts_of) {
  Plan plan{campaign.name, {}};
  for (const Vehicle& vehicle : campaign.vehicles) {
    for (const Route& route : campaign.routes) {
      const Entry& environment = campaign.environments[route.environment];
      for (std::size_t i = 0; i < campaign.radii.size(); ++i) {
        const RunCommands commands(campaign, vehicle, route, campaign.radii[i]);
        const PlannedRun run{vehicle,
                             route,
                             campaign.radii[i],
                             environment,
                             commands.run() + campaign.search_limits + campaign.limits,
                             commands.outputs()};
        Task task = make_task(campaign, commands, run, facts_of(run));
        task.vehicle = vehicle.name;
        task.route = route.name;
        task.environment = environment.name;
        task.radius = campaign.radius_names[i];
        task.outputs = commands.files();
        add_tasks(std::move(task), run, plan);
      }
    }
  }
  return plan;
}

}  // namespace clearway::campaign
