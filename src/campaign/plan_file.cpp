#include "campaign/plan_file.hpp"

#include <string_view>

#include "clearway/error.hpp"
#include "io/json/parse_json.hpp"
#include "io/system/file_text.hpp"
#include "io/system/input_error.hpp"

namespace clearway::campaign {
namespace {

using nlohmann::ordered_json;

constexpr int kFormat = 2;  // format 1 has no fingerprints of the stores of shards
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

}  // namespace clearway::campaign
