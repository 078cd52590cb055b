#include "campaign/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <numeric>
#include <ranges>
#include <set>
#include <span>
#include <string_view>
#include <system_error>

#include "clearway/error.hpp"
#include "core/describe/query.hpp"
#include "core/util/format.hpp"
#include "io/files/header_values.hpp"
#include "io/files/input_error.hpp"
#include "io/files/text_lines.hpp"
#include "io/files/text_number.hpp"
#include "io/files/xxh64.hpp"
#include "io/result/journal.hpp"

namespace clearway::campaign {

namespace fs = std::filesystem;

namespace {

Json ignored_of(const ResultHeader& header) {
  Json boxes = Json::array();
  for (const Box& box : header.ignore_boxes) {
    boxes.push_back({box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z});
  }
  Json ignored{{"classes", header.ignore_classes}, {"boxes", boxes}};
  if (!header.ignore_classes.empty()) ignored["classes_hash"] = hash_text(header.classes_hash);
  return ignored;
}

/// Turns the question of a result into that of one of its parts. store: the fingerprint as text,
/// because parts of two stores of the same points do not fit together.
void ask_for_part(const Shard& shard, const std::string& store, Json& question) {
  question["shard"] = to_string(shard);
  question["store"] = store;
}

}  // namespace

Json parameters_json(const QueryParameters& query) {
  Json parameters;
  for_each_field(kQueryValues, [&](const auto& field) {
    if (!is_listed(field, query)) return;
    const auto& value = field.of(query);
    if constexpr (requires { value.has_value(); }) {
      parameters[field.key] = *value;
    } else {
      parameters[field.key] = value;
    }
  });
  return parameters;
}

Json question_of(const ResultHeader& header) {
  Json question = parameters_json(header);
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

Json question_in(const fs::path& file) {
  std::error_code unknown;
  if (!fs::exists(file, unknown)) return nullptr;
  try {
    return question_of(ResultReader(file, Parts::kAccepted).header());
  } catch (const Error&) {
    return nullptr;
  }
}

bool is_journal_of_others(const fs::path& file, const Json& question) {
  std::error_code unknown;
  if (!fs::exists(file, unknown)) return false;
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

std::string output_of(const Command& command) {
  return command[0] == "run" ? "run.json" : command[0] == "conflicts" ? "summary.json" : "";
}

namespace {

std::string id_of(const Json& value) {
  const std::string text = value.dump();
  return hash_text(xxh64(std::as_bytes(std::span(text))));
}

Command with_arguments(Command words, const Arguments& arguments) {
  for (const Argument& argument : arguments) words.push_back(argument.text());
  return words;
}

/// The words that `clearway run` begins with, for a run or for a shard.
Command run_words(const Task& task) {
  Command words{"run", "--resume", "--json", std::string("--output=") + task.result()};
  if (task.shard) words.push_back("--shard=" + to_string(*task.shard));
  return words;
}

/// The commands that make the outputs of a run. title: of its report.
std::vector<std::pair<Commands, Command>> output_commands(const Campaign& campaign,
                                                          const std::string& title) {
  std::vector<std::pair<Commands, Command>> out;
  if (campaign.report) {
    out.emplace_back(kReport, Command{"report", kResultName, "--force",
                                      std::string("--output=") + kReportName, "--title=" + title});
  }
  if (campaign.conflict_formats.empty()) return out;
  Command conflicts{"conflicts", kResultName, "--force", "--json"};
  for (const std::string& format : campaign.conflict_formats) {
    conflicts.push_back("--output=conflicts." + format);
  }
  if (!campaign.ledgers.empty()) conflicts.emplace_back("--update");
  // They update the ledger, so the page is made before, and shows what is gone.
  out.emplace(campaign.ledgers.empty() ? out.begin() : out.end(), kFind, std::move(conflicts));
  return out;
}

PlannedRun planned_run(const Campaign& campaign, const Entry& vehicle, const Entry& route,
                       const Argument& radius, const std::string& ledger) {
  PlannedRun run{
      vehicle,
      route,
      campaign.environments[route.environment],
      {},
      campaign.limits,
      output_commands(campaign, campaign.name + ": " + vehicle.name + " on " + route.name)};
  for (const Arguments& some :
       {run.environment.arguments, vehicle.arguments, route.arguments, Arguments{radius},
        campaign.query, campaign.outputs, Arguments{{"", "--device", "cpu", kReread}}}) {
    run.arguments.insert(run.arguments.end(), some.begin(), some.end());
  }
  if (!ledger.empty()) {
    run.arguments.front().commands |= kFind;  // the environment
    run.arguments.push_back({"outputs.ledger", "--ledger", ledger, kFindings});
  }
  return run;
}

/// The task that makes the result and the outputs of a run.
Task make_task(const PlannedRun& run, const RunFacts& facts) {
  Task task;
  task.unit = facts.unit;
  task.question = facts.question;
  if (facts.shards > 1) {
    task.shards = facts.shards;
    task.store = facts.store;
    Command merge{"merge", "--resume", std::string("--output=") + kResultName};
    for (std::uint32_t number = 1; number <= task.shards; ++number) {
      merge.push_back("shards/" + std::to_string(number) + "/" + kPartName);
    }
    task.commands.push_back(with_arguments(std::move(merge), run.taken_by(kMerge)));
  }
  task.commands.push_back(
      with_arguments(run_words(task), run.taken_by(task.shards > 0 ? kReread : kSearch)));
  Json made = Json::array();
  for (const auto& [command, words] : run.outputs) {
    made.push_back(with_arguments(words, run.taken_by(command, false)));
    task.commands.push_back(with_arguments(words, run.taken_by(command)));
  }
  task.outputs_id = id_of(made);
  return task;
}

}  // namespace

Arguments PlannedRun::taken_by(unsigned command, bool with_limits) const {
  Arguments out;
  for (const Arguments& some : {arguments, with_limits ? limits : Arguments{}}) {
    std::ranges::copy_if(some, std::back_inserter(out), [command](const Argument& argument) {
      return (argument.commands & command) != 0;
    });
  }
  return out;
}

std::string Task::question_id() const { return id_of(question); }

Task shard_of(const Task& merge, std::uint32_t number) {
  Task shard = merge;
  shard.shard = Shard{number, merge.shards};
  shard.shards = 0;
  ask_for_part(*shard.shard, merge.store, shard.question);
  shard.store.clear();
  shard.ledger.clear();
  shard.outputs.clear();
  shard.commands.clear();
  shard.outputs_id = id_of(Json::array());
  return shard;
}

Plan make_plan(const Campaign& campaign,
               const std::function<RunFacts(const PlannedRun&)>& facts_of) {
  Plan plan{campaign.name, {}};
  const auto add = [&plan](Task&& task) {
    task.number = plan.tasks.size();
    plan.tasks.push_back(std::move(task));
  };
  const auto add_run = [&](const Entry& vehicle, const Entry& route, const Argument& radius) {
    fs::path ledger = campaign.ledgers;
    if (!ledger.empty()) ledger = ledger / vehicle.name / route.name / (radius.value + ".csv");
    const PlannedRun run = planned_run(campaign, vehicle, route, radius, ledger.string());
    Task task = make_task(run, facts_of(run));
    task.vehicle = vehicle.name;
    task.route = route.name;
    task.environment = run.environment.name;
    task.radius = radius.value;
    task.ledger = ledger.string();
    task.inputs = {{"environment", run.environment.file.string()},
                   {vehicle.arguments.front().option.substr(2), vehicle.file.string()},
                   {"trajectory", route.file.string()}};
    for (const std::string& format : campaign.conflict_formats) {
      task.outputs.push_back("conflicts." + format);
    }
    if (campaign.report) task.outputs.emplace_back(kReportName);
    for (std::uint32_t number = 1; number <= task.shards; ++number) {
      Task shard = shard_of(task, number);
      shard.commands.push_back(with_arguments(run_words(shard), run.taken_by(kSearch)));
      add(std::move(shard));
    }
    add(std::move(task));
  };
  for (const Entry& vehicle : campaign.vehicles) {
    for (const Entry& route : campaign.routes) {
      for (const Argument& radius : campaign.radii) add_run(vehicle, route, radius);
    }
  }
  return plan;
}

void keep_facts(HeaderValues& values, TaskInput& input) {
  values.add("what", input.what);
  values.add("file", input.file);
}

void keep_facts(HeaderValues& values, Task& task) {
  values.add("task", task.number);
  values.add("vehicle", task.vehicle);
  values.add("route", task.route);
  values.add("environment", task.environment);
  values.add("radius", task.radius);
  values.add("unit", task.unit);
  std::string folder = task.folder().string();
  values.add("folder", folder);
  std::optional<std::array<std::uint32_t, 2>> shard;
  if (task.shard) shard = {task.shard->number, task.shard->count};
  values.add("shard", shard);
  if (shard) task.shard = Shard{shard->front(), shard->back()};
  values.add_if(task.shards > 0, "shards", task.shards);
  values.add_if(task.shards > 0, "store", task.store);
  values.add("inputs", task.inputs);
  values.add_if(!task.ledger.empty(), "ledger", task.ledger);
  values.add("outputs", task.outputs);
  values.add("outputs_id", task.outputs_id);
  values.add("commands", task.commands);
}

namespace {

constexpr std::uint32_t kFormat = 3;
constexpr std::string_view kEnd = "]}";

/// The task on a line of a plan. name: the file's.
Task task_of(std::string_view line, std::size_t number, const std::string& name) {
  if (line.ends_with(',')) line.remove_suffix(1);
  const Json json = parse_json(line);
  HeaderValues values(json, name);
  Task task;
  keep_facts(values, task);
  task.question = json.value("question", Json());
  const auto is_empty = [](const Command& command) { return command.empty(); };
  if (task.number != number || task.commands.empty() ||
      std::ranges::any_of(task.commands, is_empty)) {
    throw JsonError("its tasks are not in order");
  }
  return task;
}

}  // namespace

std::string plan_text(const Plan& plan) {
  std::string text =
      fmt::format("{{\"format\":{},\"campaign\":{},\"tasks\":[\n", kFormat, Json(plan.name).dump());
  for (const Task& task : plan.tasks) {
    Json line = as_header(task);
    line["question"] = task.question;
    text += line.dump() + (&task == &plan.tasks.back() ? "\n" : ",\n");
  }
  return text + std::string(kEnd) + "\n";
}

Plan read_plan(const fs::path& folder, const std::optional<TaskList>& tasks) {
  const std::string file = (folder / kPlanName).string();
  std::error_code unknown;
  if (!fs::exists(file, unknown)) {
    throw UsageError(folder.string() +
                     ": holds no campaign; clearway campaign plan makes one there");
  }
  const std::string text = text_of_file(file);
  std::vector<std::string_view> lines;
  for (std::string_view rest = text; !rest.empty();) lines.push_back(take_line(rest));
  const std::size_t count = std::max<std::size_t>(lines.size(), 2) - 2;
  TaskList numbers = tasks.value_or(TaskList(count));
  if (!tasks) std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  std::string damage;
  try {
    if (lines.size() < 2 || lines.back() != kEnd) throw JsonError("its end is missing");
    const Json head = parse_json(std::string(lines.front()) + std::string(kEnd));
    HeaderValues values(head, file);
    std::uint32_t format = 0;
    Plan plan;
    values.add("format", format);
    if (format != kFormat) throw JsonError("it is of another version of clearway");
    values.add("campaign", plan.name);
    for (const std::size_t number : numbers) {
      if (number >= count) {
        throw UsageError(
            fmt::format("--task {}: the plan has the tasks 0 to {}", number, count - 1));
      }
      plan.tasks.push_back(task_of(lines[number + 1], number, file));
    }
    return plan;
  } catch (const JsonError& error) {
    damage = error.what();
  } catch (const InputError& error) {
    damage = error.what();
  }
  refuse(file, "is damaged: " + damage + "; clearway campaign plan --force makes it again");
}

std::string task_list_text(const TaskList& tasks) {
  return fmt::format("{}", fmt::join(number_ranges(tasks), ","));
}

std::optional<TaskList> parse_task_list(std::string_view text) {
  constexpr std::size_t kMostTasks = 10'000'000;
  std::set<std::size_t> tasks;
  for (const auto part : std::views::split(text, ',')) {
    const std::string_view range(part.begin(), part.end());
    const std::size_t dash = std::min(range.find('-'), range.size());
    const auto first = parse_count(range.substr(0, dash));
    const auto last = dash < range.size() ? parse_count(range.substr(dash + 1)) : first;
    if (!first || !last || *last < *first || *last >= kMostTasks) return std::nullopt;
    for (std::size_t task = *first; task <= *last; ++task) tasks.insert(task);
  }
  return TaskList(tasks.begin(), tasks.end());
}

}  // namespace clearway::campaign
