#include "campaign/plan.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>
#include <type_traits>

#include "clearway/error.hpp"
#include "core/describe/query.hpp"
#include "core/util/format.hpp"
#include "io/files/input_error.hpp"
#include "io/files/json.hpp"
#include "io/files/xxh64.hpp"
#include "io/result/journal.hpp"

namespace clearway::campaign {
namespace {

nlohmann::ordered_json ignored_of(const ResultHeader& header) {
  nlohmann::ordered_json boxes = nlohmann::ordered_json::array();
  for (const Box& box : header.ignore_boxes) {
    boxes.push_back({box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z});
  }
  nlohmann::ordered_json ignored{{"classes", header.ignore_classes}, {"boxes", boxes}};
  if (!header.ignore_classes.empty()) ignored["classes_hash"] = hash_text(header.classes_hash);
  return ignored;
}

/// The question that a complete result or part answers; nothing where there is no such file.
std::optional<nlohmann::ordered_json> question_in(const std::filesystem::path& file) {
  std::error_code unknown;
  if (!std::filesystem::exists(file, unknown)) return std::nullopt;
  try {
    return question_of(ResultReader(file, Parts::kAccepted).header());
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

void ask_for_part(const Shard& shard, const std::string& store, nlohmann::ordered_json& question) {
  question["shard"] = to_string(shard);
  question["store"] = store;
}

nlohmann::ordered_json parameters_json(const QueryParameters& query) {
  nlohmann::ordered_json parameters;
  for_each_field(kQueryValues, [&](const auto& field) {
    if (!is_listed(field, query)) return;
    if constexpr (std::is_same_v<std::decay_t<decltype(field.of(query))>, std::optional<double>>) {
      parameters[field.key] = *field.of(query);
    } else {
      parameters[field.key] = field.of(query);
    }
  });
  return parameters;
}

nlohmann::ordered_json question_of(const ResultHeader& header) {
  nlohmann::ordered_json question = parameters_json(header);
  question.update({{"environment_points", header.environment_points},
                   {"environment_hash", hash_text(header.environment_hash)},
                   {"model_points", header.model_points},
                   {"model_hash", hash_text(header.model_hash)},
                   {"poses", header.poses},
                   {"trajectory_hash", hash_text(header.trajectory_hash)}});
  if (header.ignores_points()) question["ignored"] = ignored_of(header);
  if (header.model_triangles > 0) question["model_triangles"] = header.model_triangles;
  if (const ModelAxes axes = header.notes.model_axes; axes.need_turn()) {
    question["model_axes"] = {name_of(axes.forward), name_of(axes.up)};
  }
  if (header.part) ask_for_part(header.part->shard, hash_text(header.part->store), question);
  return question;
}

bool answers(const std::filesystem::path& file, const nlohmann::ordered_json& question) {
  return question_in(file) == question;
}

bool answers_another(const std::filesystem::path& file, const nlohmann::ordered_json& question) {
  const auto found = question_in(file);
  return found && *found != question;
}

bool is_journal_of_others(const std::filesystem::path& file,
                          const nlohmann::ordered_json& question) {
  std::error_code unknown;
  if (!std::filesystem::exists(file, unknown)) return false;
  try {
    const JournalReader journal(file);
    if (!journal.identity()) return false;
    return std::ranges::any_of(*journal.identity(), [&](const auto& field) {
      const auto& [name, value] = field;
      return (name == "model" && question["model_hash"] != value) ||
             (name == "trajectory" && question["trajectory_hash"] != value);
    });
  } catch (const Error&) {
    return false;  // the run reports what is wrong with it
  }
}

namespace {

constexpr std::string_view kLedgerWord = "--ledger=";

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
  /// radius: the index of one of the campaign's radii.
  RunCommands(const Campaign& campaign, const Vehicle& vehicle, const Route& route,
              std::size_t radius)
      : campaign_(campaign),
        vehicle_(vehicle),
        route_(route),
        environment_(campaign.environments[route.environment]),
        model_(Arguments{file_argument(vehicle, vehicle.has_bodies() ? "--vehicle" : "--model")} +
               vehicle.arguments),
        path_(Arguments{file_argument(route, "--trajectory")} + route.arguments),
        radius_(campaign.radii[radius]),
        radius_name_(campaign.radius_names[radius]) {}

  Arguments run() const {
    return Arguments{file_argument(environment_, "--env")} + model_ + vehicle_.kind + path_ +
           Arguments{radius_} + campaign_.query;
  }

  std::vector<std::pair<Command, Arguments>> outputs() const {
    std::vector<std::pair<Command, Arguments>> out;
    if (campaign_.report) {
      const std::string title = campaign_.name + ": " + vehicle_.name + " on " + route_.name;
      out.emplace_back(Command{"report", kResultName, "--force",
                               std::string("--output=") + kReportName, "--title=" + title},
                       Arguments{file_argument(environment_, "--env")} + model_ + path_ +
                           vehicle_.axes + route_.chainage + campaign_.conflicts + ledger() +
                           campaign_.classes);
    }
    // They update the ledger, so the page is made before, and shows what is gone.
    const auto place = campaign_.ledgers.empty() ? out.begin() : out.end();
    if (!campaign_.conflict_formats.empty()) out.insert(place, conflicts());
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
  /// The command that finds the conflicts. The model gives the shifts and the sides, and pictures
  /// show it.
  std::pair<Command, Arguments> conflicts() const {
    Command command{"conflicts", kResultName, "--force", "--show=0"};
    for (const std::string& format : campaign_.conflict_formats) {
      command.push_back("--output=conflicts." + format);
    }
    Arguments arguments = path_ + model_ + vehicle_.axes + route_.chainage + campaign_.conflicts;
    if (!campaign_.ledgers.empty()) {
      command.push_back("--update");
      arguments = arguments + ledger() + Arguments{file_argument(environment_, "--env")};
    }
    return {std::move(command), std::move(arguments)};
  }

  /// The option that names the ledger of the run, which no other run has, so that runs at the same
  /// time do not meet.
  Arguments ledger() const {
    if (campaign_.ledgers.empty()) return {};
    const std::filesystem::path table =
        campaign_.ledgers / vehicle_.name / route_.name / (radius_name_ + ".csv");
    return {{"outputs.ledger", "--ledger", std::string(kLedgerWord) + table.string()}};
  }

  const Campaign& campaign_;
  const Vehicle& vehicle_;
  const Route& route_;
  const Entry& environment_;
  Arguments model_, path_;
  const Argument& radius_;
  const std::string& radius_name_;
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

std::filesystem::path Task::ledger() const {
  for (const Command& command : commands) {
    for (const std::string& word : command) {
      if (word.starts_with(kLedgerWord)) return word.substr(kLedgerWord.size());
    }
  }
  return {};
}

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
        const RunCommands commands(campaign, vehicle, route, i);
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

namespace {

using nlohmann::ordered_json;

constexpr int kFormat = 2;
constexpr std::string_view kEnd = "]}";

ordered_json json_of(const Task& task) {
  ordered_json line{{"task", task.number},
                    {"vehicle", task.vehicle},
                    {"route", task.route},
                    {"environment", task.environment},
                    {"radius", task.radius},
                    {"unit", task.unit},
                    {"folder", task.folder().string()}};
  if (task.shard) line["shard"] = {task.shard->number, task.shard->count};
  if (task.shards > 0) {
    line["shards"] = task.shards;
    line["store"] = task.store;
  }
  line["question"] = task.question;
  line["outputs"] = task.outputs;
  line["outputs_id"] = task.outputs_id;
  line["commands"] = task.commands;
  return line;
}

Task task_of(const ordered_json& line) {
  Task task;
  line.at("task").get_to(task.number);
  line.at("vehicle").get_to(task.vehicle);
  line.at("route").get_to(task.route);
  line.at("environment").get_to(task.environment);
  line.at("radius").get_to(task.radius);
  line.at("unit").get_to(task.unit);
  if (line.contains("shard")) {
    const ordered_json& shard = line["shard"];
    task.shard = Shard{shard.at(0).get<std::uint32_t>(), shard.at(1).get<std::uint32_t>()};
  }
  if (line.contains("shards")) {
    line["shards"].get_to(task.shards);
    line.at("store").get_to(task.store);
  }
  task.question = line.at("question");
  line.at("outputs").get_to(task.outputs);
  line.at("outputs_id").get_to(task.outputs_id);
  line.at("commands").get_to(task.commands);
  return task;
}

/// The lines of a plan: a head, one line for each task, and the end.
class PlanLines {
  template <typename Read>
  auto guarded(const Read& read) const {
    try {
      return read();
    } catch (const JsonError& error) {
      damaged(error.what());
    } catch (const ordered_json::exception& error) {
      damaged(error.what());
    }
  }

 public:
  explicit PlanLines(const std::filesystem::path& folder) : file_(folder / kPlanName) {
    std::error_code unknown;
    if (!std::filesystem::exists(file_, unknown)) {
      throw UsageError(folder.string() +
                       ": holds no campaign; clearway campaign plan makes one there");
    }
    text_ = text_of_file(file_);
    for (std::string_view rest = text_; !rest.empty();) {
      const std::size_t end = std::min(rest.find('\n'), rest.size());
      lines_.push_back(rest.substr(0, end));
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    if (lines_.size() < 2 || lines_.back() != kEnd) damaged("its end is missing");
  }

  std::size_t tasks() const { return lines_.size() - 2; }

  std::string name() const {
    return guarded([&] {
      const ordered_json head = parse_json(std::string(lines_[0]) + std::string(kEnd));
      if (head.at("format") != kFormat) damaged("it is of another version of clearway");
      return head.at("campaign").get<std::string>();
    });
  }

  Task task(std::size_t number) const {
    return guarded([&] {
      std::string_view line = lines_[number + 1];
      if (line.ends_with(',')) line.remove_suffix(1);
      Task task = task_of(parse_json(line));
      if (task.number != number || task.commands.empty()) damaged("its tasks are not in order");
      return task;
    });
  }

 private:
  [[noreturn]] void damaged(const std::string& why) const {
    refuse(file_.string(),
           "is damaged: " + why + "; clearway campaign plan --force makes it again");
  }

  std::filesystem::path file_;
  std::string text_;
  std::vector<std::string_view> lines_;
};

}  // namespace

std::string plan_text(const Plan& plan) {
  std::string text = ordered_json{{"format", kFormat}, {"campaign", plan.name}}.dump();
  text.pop_back();
  text += ",\"tasks\":[\n";
  for (const Task& task : plan.tasks) {
    text += json_of(task).dump() + (&task == &plan.tasks.back() ? "\n" : ",\n");
  }
  return text + std::string(kEnd) + "\n";
}

Plan read_plan(const std::filesystem::path& folder) {
  const PlanLines lines(folder);
  Plan plan{lines.name(), {}};
  for (std::size_t i = 0; i < lines.tasks(); ++i) plan.tasks.push_back(lines.task(i));
  return plan;
}

Plan read_plan(const std::filesystem::path& folder, const TaskList& tasks) {
  const PlanLines lines(folder);
  Plan plan{lines.name(), {}};
  for (const std::size_t number : tasks) {
    if (number >= lines.tasks()) {
      throw UsageError("--task " + std::to_string(number) + ": the plan has the tasks 0 to " +
                       std::to_string(lines.tasks() - 1));
    }
    plan.tasks.push_back(lines.task(number));
  }
  return plan;
}

namespace {

constexpr std::size_t kMostTasks = 10'000'000;

std::optional<std::size_t> task_number(std::string_view text) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole && number < kMostTasks ? std::optional(number) : std::nullopt;
}

}  // namespace

std::string task_list_text(const TaskList& tasks) {
  std::string text;
  for (const std::string& range : number_ranges(tasks)) text += (text.empty() ? "" : ",") + range;
  return text;
}

std::optional<TaskList> parse_task_list(const std::string& text) {
  TaskList tasks;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    const std::string_view part = std::string_view(text).substr(begin, comma - begin);
    const std::size_t dash = std::min(part.find('-'), part.size());
    const auto first = task_number(part.substr(0, dash));
    const auto last = dash < part.size() ? task_number(part.substr(dash + 1)) : first;
    if (!first || !last || *last < *first) return std::nullopt;
    for (std::size_t task = *first; task <= *last; ++task) tasks.push_back(task);
    begin = comma + 1;
  }
  std::ranges::sort(tasks);
  tasks.erase(std::unique(tasks.begin(), tasks.end()), tasks.end());
  return tasks;
}

}  // namespace clearway::campaign
