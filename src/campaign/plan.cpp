#include "campaign/plan.hpp"

#include <span>

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
        model_(Arguments{file_argument(vehicle, "--model")} + vehicle.arguments),
        path_(Arguments{file_argument(route, "--trajectory")} + route.arguments),
        radius_(radius) {}

  Arguments run() const {
    return Arguments{file_argument(environment_, "--env")} + model_ + path_ + Arguments{radius_} +
           campaign_.query;
  }

  std::vector<std::pair<Command, Arguments>> outputs() const {
    std::vector<std::pair<Command, Arguments>> out;
    if (!campaign_.conflict_formats.empty()) out.push_back(conflicts());
    if (campaign_.report) {
      const std::string title = campaign_.name + ": " + vehicle_.name + " on " + route_.name;
      out.emplace_back(Command{"report", kResultName, "--force",
                               std::string("--output=") + kReportName, "--title=" + title},
                       Arguments{file_argument(environment_, "--env")} + model_ + path_ +
                           vehicle_.axes + campaign_.conflicts + campaign_.classes);
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
  /// Pictures show the model; the other formats need the trajectory alone.
  std::pair<Command, Arguments> conflicts() const {
    Command command{"conflicts", kResultName, "--force", "--show=0"};
    bool pictures = false;
    for (const std::string& format : campaign_.conflict_formats) {
      command.push_back("--output=conflicts." + format);
      pictures = pictures || format == "bcf";
    }
    return {std::move(command),
            path_ + (pictures ? model_ : Arguments{}) + vehicle_.axes + campaign_.conflicts};
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

Task make_task(const Campaign& campaign, const PlannedRun& run, const RunFacts& facts) {
  Task task;
  task.question = facts.question;
  task.unit = facts.unit;
  auto made = nlohmann::ordered_json::array();
  task.commands.push_back(with_arguments(
      {"run", "--resume", "--json", std::string("--output=") + kResultName}, run.arguments, {}));
  for (const auto& [command, arguments] : run.outputs) {
    made.push_back(with_arguments(command, arguments, {}));
    task.commands.push_back(with_arguments(command, arguments, campaign.limits));
  }
  task.outputs_id = id_of(made);
  return task;
}

}  // namespace

std::string Task::question_id() const { return id_of(question); }

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
        Task task = make_task(campaign, run, facts_of(run));
        task.number = plan.tasks.size();
        task.vehicle = vehicle.name;
        task.route = route.name;
        task.environment = environment.name;
        task.radius = campaign.radius_names[i];
        task.outputs = commands.files();
        plan.tasks.push_back(std::move(task));
      }
    }
  }
  return plan;
}

}  // namespace clearway::campaign
