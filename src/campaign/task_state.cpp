#include "campaign/task_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <filesystem>
#include <span>
#include <system_error>
#include <utility>

#include "clearway/error.hpp"
#include "clearway/ledger.hpp"
#include "core/util/exit_code.hpp"
#include "io/files/file.hpp"
#include "io/files/header_values.hpp"
#include "io/files/input_error.hpp"
#include "io/files/xxh64.hpp"
#include "io/models/vehicle_file.hpp"
#include "io/scans/point_reader.hpp"

namespace clearway::campaign {

namespace fs = std::filesystem;

namespace {

constexpr const char* kStateName = "state.json";

std::optional<InputStamp> stamp_of(const TaskInput& input) {
  const std::vector<fs::path> files = files_behind(input.file);
  if (files.empty()) return std::nullopt;
  InputStamp all{input};
  Xxh64Stream hash;
  for (const fs::path& file : files) {
    std::error_code failed;
    const std::uintmax_t bytes = fs::file_size(file, failed);
    if (failed) return std::nullopt;
    const fs::file_time_type time = fs::last_write_time(file, failed);
    if (failed) return std::nullopt;
    using Nanoseconds = std::chrono::nanoseconds;
    all.modified = static_cast<std::uint64_t>(
        std::chrono::duration_cast<Nanoseconds>(time.time_since_epoch()).count());
    all.bytes += bytes;
    const std::string state =
        fmt::format("{} {} {}\n", file.filename().string(), bytes, all.modified);
    hash.update(std::as_bytes(std::span(state)));
  }
  if (files.size() > 1) all.modified = hash.digest();
  return all;
}

/// The files that a vehicle's file names; none where it cannot be read, which the run will report.
std::vector<TaskInput> inputs_of_bodies(const fs::path& vehicle) {
  std::vector<TaskInput> inputs;
  try {
    for (const BodyEntry& body : read_vehicle_file(vehicle, 1)) {
      for (const fs::path& file : body.files()) {
        inputs.push_back({file == body.trajectory ? "trajectory" : "model", file.string()});
      }
    }
  } catch (const Error&) {
    inputs.clear();
  }
  return inputs;
}

}  // namespace

std::vector<InputStamp> stamps_of(const Task& task) {
  std::vector<TaskInput> inputs = task.inputs;
  for (const TaskInput& input : task.inputs) {
    if (input.what != "vehicle") continue;
    const std::vector<TaskInput> bodies = inputs_of_bodies(input.file);
    inputs.insert(inputs.end(), bodies.begin(), bodies.end());
  }
  std::vector<InputStamp> stamps;
  for (const TaskInput& input : inputs) {
    const auto stamp = stamp_of(input);
    if (stamp && std::ranges::find(stamps, *stamp) == stamps.end()) stamps.push_back(*stamp);
  }
  return stamps;
}

std::string changed_since(const std::vector<InputStamp>& stamps) {
  std::vector<std::string> changed;
  for (const InputStamp& stamp : stamps) {
    const auto now = stamp_of(stamp);
    if (!now || *now == stamp) continue;
    changed.push_back("the " + stamp.what + " file " + fs::path(stamp.file).filename().string() +
                      " changed");
  }
  return changed.empty() ? "" : fmt::format("{} since this run", fmt::join(changed, ", "));
}

const char* name_of(Status status) {
  constexpr const char* kNames[]{"done",     "running", "begun",  "interrupted",
                                 "outdated", "failed",  "missing"};
  return kNames[static_cast<std::size_t>(status)];
}

void keep_facts(HeaderValues& values, InputStamp& stamp) {
  values.add("what", stamp.what);
  values.add("file", stamp.file);
  values.add("bytes", stamp.bytes);
  values.add("modified", stamp.modified);
}

void keep_facts(HeaderValues& values, TaskState& state) {
  std::string ending = name_of(state.ending);
  values.add("state", ending);
  for (const Status status : kStatuses) {
    if (ending == name_of(status)) state.ending = status;
  }
  values.add("exit_code", state.exit_code);
  values.add("message", state.message);
  values.add("tries", state.tries);
  values.add("seconds", state.seconds);
  values.add("host", state.host);
  values.add("time", state.time);
  values.add("question_id", state.question_id);
  values.add("outputs_id", state.outputs_id);
  values.add("inputs_changed", state.inputs_changed);
  values.add("inputs", state.inputs);
}

std::optional<TaskState> read_state(const fs::path& folder) {
  std::error_code unknown;
  const std::string file = (folder / kStateName).string();
  if (!fs::exists(file, unknown)) return std::nullopt;
  try {
    const Json json = parse_json(text_of_file(file));
    HeaderValues values(json, file);
    TaskState state;
    keep_facts(values, state);
    state.facts = json.value("facts", Json());
    return state;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

void write_state(const fs::path& folder, const TaskState& state) {
  Json json = as_header(state);
  json["facts"] = state.facts;
  replace_file(folder / kStateName, indented_text(json, 1));
}

namespace {

/// Reads what a command printed into its file as JSON, and takes facts from it.
template <typename Take>
void take_printed(const fs::path& file, const Take& take) {
  const std::string text = text_of_file(file);
  try {
    take(parse_json(text));
  } catch (const std::exception& error) {
    throw ResourceError(file.string() + ": is not what the command printed: " + error.what());
  }
}

Json place_of(const Json& place) {
  if (place.is_null()) return nullptr;
  Json out{{"pose", place.at("pose")}, {"chainage", place.at("chainage")}};
  if (place.contains("distance")) out["distance"] = place.at("distance");
  return out;
}

/// The counts of ignored points; null where the query ignores nothing.
Json ignored_of(const Json& ignored) {
  if (ignored.at("classes").empty() && ignored.at("boxes").empty()) return nullptr;
  return {{"points", ignored.at("points")}, {"colliding", ignored.value("colliding", Json())}};
}

Json facts_of_run(const Json& run) {
  Json codes = Json::array(), texts = Json::array();
  for (const Json& warning : run.at("warnings")) {
    codes.push_back(warning.at("code"));
    texts.push_back(warning.at("message"));
  }
  const Json& profile = run.at("least_profile");
  Json facts{{"verdict", run.at("verdict")},
             {"reasons", run.value("reasons", Json::array())},
             {"doubts", run.value("doubts", Json::array())},
             {"colliding_points", run.at("colliding_points")},
             {"ignored", ignored_of(run.at("ignored"))},
             {"floor", run.value("floor", Json())},
             {"least", place_of(profile.is_null() ? run.at("least_clearance") : profile)},
             {"least_side", run.value("least_side", Json())},
             {"first", place_of(run.at("first_place"))},
             {"warnings", std::move(codes)},
             {"warning_texts", std::move(texts)}};
  if (const Json seen = run.value("seen", Json()); !seen.is_null()) facts["seen"] = seen;
  if (run.contains("classes")) facts["classes"] = run["classes"];
  return facts;
}

void add_conflicts(const Json& summary, Json& facts) {
  const Json& count = summary.at("conflict_count");
  if (summary.contains("ledger")) {
    const Json& ledger = summary["ledger"];
    facts["ledger"] = {{"conflicts", count},
                       {"accepted_conflicts", ledger.at("accepted_conflicts")},
                       {"outside", ledger.at("outside").at("verdict")}};
    for (std::size_t i = 0; i < kLedgerStatuses; ++i) {
      const char* const status = name_of(static_cast<LedgerStatus>(i));
      facts["ledger"][status] = ledger.at(status);
    }
  }
  facts["conflicts"] = {{"count", count}};
}

LockState task_lock(const fs::path& folder) {
  std::error_code unknown;
  if (!fs::exists(folder / kLockName, unknown)) return LockState::kFree;
  try {
    return lock_state(File::open_for_reading(folder / kLockName));
  } catch (const ResourceError&) {
    return LockState::kUnknown;
  }
}

/// The state of the last try, where it has the plan's question, whatever its outputs.
std::optional<TaskState> state_of(const Task& task, const fs::path& folder) {
  std::optional<TaskState> state = read_state(folder);
  if (state && state->question_id != task.question_id()) state.reset();
  return state;
}

/// Whether the try finished its task, even if its inputs have changed since.
bool is_finished(const Task& task, const fs::path& campaign,
                 const std::optional<TaskState>& state) {
  const fs::path folder = campaign / task.folder();
  const auto exists = [&](const std::string& name) {
    std::error_code unknown;
    return fs::exists(folder / name, unknown);
  };
  return state && state->ending == Status::kDone && state->question_id == task.question_id() &&
         state->outputs_id == task.outputs_id && std::ranges::all_of(task.outputs, exists) &&
         has_result(task, campaign);
}

/// The status of a task that is not done.
Status status_by(const std::optional<TaskState>& state, LockState lock) {
  if (lock == LockState::kHeld) return Status::kRunning;
  if (!state) return Status::kMissing;
  if (state->ending == Status::kFailed) return Status::kFailed;
  const bool is_begun = state->ending == Status::kBegun && lock == LockState::kUnknown;
  // One that is done lacks outputs, or has those of another plan.
  return is_begun ? Status::kBegun : Status::kInterrupted;
}

}  // namespace

Json task_facts(const Task& task, const fs::path& folder) {
  Json facts;
  for (const Command& command : task.commands) {
    const std::string output = output_of(command);
    if (output.empty()) continue;
    take_printed(folder / output, [&](const Json& printed) {
      if (command[0] == "run") {
        facts = facts_of_run(printed);
      } else {
        add_conflicts(printed, facts);
      }
    });
  }
  return facts;
}

const Json& TaskStatus::facts() const {
  static const Json kNone;
  return status == Status::kDone && state ? state->facts : kNone;
}

bool has_result(const Task& task, const fs::path& campaign) {
  return question_in(campaign / task.folder() / task.result()) == task.question;
}

bool is_done(const Task& task, const fs::path& campaign, const std::optional<TaskState>& state) {
  if (task.shard) {
    Task run = task;
    run.shard.reset();
    run.question.erase("shard");
    run.question.erase("store");
    if (has_result(run, campaign)) return true;
  }
  return is_finished(task, campaign, state) && changed_since(state->inputs).empty();
}

TaskStatus status_of(const Task& task, const fs::path& campaign) {
  const fs::path folder = campaign / task.folder();
  for (;;) {
    TaskStatus out{.task = &task, .status = Status::kDone, .state = state_of(task, folder)};
    if (is_done(task, campaign, out.state)) return out;
    const LockState lock = task_lock(folder);
    out.status = status_by(out.state, lock);
    if (lock == LockState::kHeld) return out;
    // The process that held the lock may have ended, or another may have begun, since the state was
    // read.
    if (state_of(task, folder) != out.state) continue;
    if (is_finished(task, campaign, out.state)) {
      out.status = Status::kOutdated;
      out.changed = changed_since(out.state->inputs);
    }
    return out;
  }
}

bool may_succeed(const TaskStatus& status) {
  if (status.status != Status::kFailed) return true;
  return status.state->exit_code == kResource || status.state->inputs_changed;
}

std::vector<TaskStatus> runs_of(const std::vector<TaskStatus>& tasks) {
  std::vector<TaskStatus> runs;
  std::optional<TaskStatus> failed;  // one of the shards that come before their run
  for (const TaskStatus& task : tasks) {
    if (task.task->shard) {
      if (task.status != Status::kFailed || failed) continue;
      failed = task;
      failed->shard = task.task->shard->number;
      continue;
    }
    TaskStatus& run = runs.emplace_back(task);
    if (failed && task.status != Status::kDone) run = *failed;
    run.task = task.task;
    failed.reset();
  }
  return runs;
}

}  // namespace clearway::campaign
