#include "campaign/task_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "campaign/plan.hpp"
#include "clearway/answer.hpp"
#include "clearway/error.hpp"
#include "clearway/ledger.hpp"
#include "core/query/point_classes.hpp"
#include "core/query/verdict_words.hpp"
#include "core/util/exit_code.hpp"
#include "core/util/format.hpp"
#include "io/files/file.hpp"
#include "io/files/input_error.hpp"
#include "io/files/json.hpp"
#include "io/files/xxh64.hpp"
#include "io/models/vehicle_file.hpp"
#include "io/result/floor_facts.hpp"
#include "io/scans/point_reader.hpp"

namespace clearway::campaign {
namespace {

namespace fs = std::filesystem;

std::optional<InputStamp> stamp_of(const std::string& what, const fs::path& input) {
  const std::vector<fs::path> files = files_behind(input);
  if (files.empty()) return std::nullopt;
  InputStamp all{what, input.string(), 0, 0};
  Xxh64Stream hash;
  for (const fs::path& file : files) {
    std::error_code failed;
    const std::uintmax_t bytes = fs::file_size(file, failed);
    if (failed) return std::nullopt;
    const fs::file_time_type time = fs::last_write_time(file, failed);
    if (failed) return std::nullopt;
    using Nanoseconds = std::chrono::nanoseconds;
    all.modified = std::chrono::duration_cast<Nanoseconds>(time.time_since_epoch()).count();
    all.bytes += bytes;
    const std::string state =
        fmt::format("{} {} {}\n", file.filename().string(), bytes, all.modified);
    hash.update(std::as_bytes(std::span(state)));
  }
  if (files.size() > 1) all.modified = static_cast<std::int64_t>(hash.digest());
  return all;
}

/// The files that a vehicle's file names; none where it cannot be read, which the run will report.
std::vector<std::pair<std::string, fs::path>> files_of_bodies(const fs::path& vehicle) {
  std::vector<std::pair<std::string, fs::path>> files;
  try {
    for (const BodyEntry& body : read_vehicle_file(vehicle, 1)) {
      for (const fs::path& file : body.files()) {
        files.emplace_back(file == body.trajectory ? "trajectory" : "model", file);
      }
    }
  } catch (const Error&) {
    files.clear();
  }
  return files;
}

/// The task's `clearway run` command, which is the second command of a merge and the first of any
/// other task; null where there is none.
const Command* run_of_commands(const Task& task) {
  const auto run = std::ranges::find_if(
      task.commands, [](const Command& words) { return !words.empty() && words[0] == "run"; });
  return run == task.commands.end() ? nullptr : &*run;
}

}  // namespace

std::vector<InputStamp> stamps_of(const Task& task) {
  constexpr std::array<std::pair<std::string_view, const char*>, 4> kOptions{
      {{"--env=", "environment"},
       {"--model=", "model"},
       {"--vehicle=", "vehicle"},
       {"--trajectory=", "trajectory"}}};
  std::vector<std::pair<std::string, fs::path>> files;
  if (const Command* run = run_of_commands(task)) {
    for (const std::string& word : *run) {
      for (const auto& [option, what] : kOptions) {
        if (word.starts_with(option)) files.emplace_back(what, word.substr(option.size()));
      }
    }
  }
  std::vector<InputStamp> stamps;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (files[i].first == "vehicle") {
      for (auto& file : files_of_bodies(files[i].second)) files.push_back(std::move(file));
    }
    auto stamp = stamp_of(files[i].first, files[i].second);
    if (stamp && std::ranges::find(stamps, *stamp) == stamps.end()) stamps.push_back(*stamp);
  }
  return stamps;
}

std::string changed_since(const std::vector<InputStamp>& stamps) {
  std::string text;
  for (const InputStamp& stamp : stamps) {
    const auto now = stamp_of(stamp.what, stamp.file);
    if (!now || *now == stamp) continue;
    text += (text.empty() ? "the " : ", the ") + stamp.what + " file " +
            fs::path(stamp.file).filename().string() + " changed";
  }
  return text.empty() ? "" : text + " since this run";
}

namespace {

using nlohmann::ordered_json;

std::string warning_words(const ordered_json& facts) {
  const ordered_json& codes = facts["warnings"];
  if (codes.empty()) return "";
  std::string text = counted(codes.size(), "warning") + " (";
  for (const auto& code : codes) {
    text += (text.ends_with('(') ? "" : ", ") + code.get<std::string>();
  }
  return text + ")";
}

}  // namespace

const OutcomeWords& words_of(Outcome outcome) {
  static constexpr std::array<OutcomeWords, kOutcomes.size()> kWords{
      {{"conflict", "■", "conflict",
        "conflict: a point is closer than the radius, or with an error budget certainly too close"},
       {"undecided", "?", "undecided",
        "undecided: a collision is neither certain nor excluded, or the question is in doubt; "
        "reasons and warnings say why"},
       {"clear_with_warnings", "△", "clear with warnings",
        "clear with warnings: nothing is closer than the radius, but read the warnings below"},
       {"clear", "○", "clear",
        "clear: no point is closer than the radius and the errors, and where seen space was asked "
        "for, all of it was scanned"},
       {"failed", "✕", "failed", "failed: nothing is known"},
       {"not_done", "…", "not done",
        "not done yet, or a file has changed since: nothing is known"}}};
  return kWords.at(static_cast<std::size_t>(outcome));
}

namespace {

Outcome outcome_by(const TaskLook& look, const ordered_json& verdict) {
  if (verdict == "clear") {
    return look.state->facts["warnings"].empty() ? Outcome::kClear : Outcome::kClearWithWarnings;
  }
  return verdict == "conflict" ? Outcome::kConflict : Outcome::kUndecided;
}

/// What the ledger of a run says; null where it has none.
ordered_json ledger_in(const TaskLook& look) {
  if (look.status != TaskStatus::kDone) return {};
  return look.state->facts.value("ledger", ordered_json());
}

}  // namespace

Outcome outcome_of(const TaskLook& look) {
  if (look.status == TaskStatus::kFailed) return Outcome::kFailed;
  if (look.status != TaskStatus::kDone) return Outcome::kUnfinished;
  return outcome_by(look, look.state->facts["verdict"]);
}

Outcome outcome_outside(const TaskLook& look) {
  const ordered_json ledger = ledger_in(look);
  return ledger.is_null() ? outcome_of(look) : outcome_by(look, ledger["outside"]);
}

std::string ledger_words(const ordered_json& ledger) {
  std::string text;
  if (ledger.is_null()) return text;
  for (std::size_t i = 0; i < kLedgerStatuses; ++i) {
    const char* const status = name_of(static_cast<LedgerStatus>(i));
    const auto count = ledger.value(status, std::uint64_t{0});
    if (count > 0) text += (text.empty() ? "" : ", ") + format_count(count) + " " + status;
  }
  return text;
}

ordered_json ledgers_of(const std::vector<TaskLook>& looks) {
  ordered_json sums;
  for (const TaskLook& look : looks) {
    const ordered_json ledger = ledger_in(look);
    if (ledger.is_null()) continue;
    if (sums.is_null()) sums = ordered_json::object();
    for (const auto& [key, count] : ledger.items()) {
      if (!count.is_number()) continue;
      sums[key] = sums.value(key, std::uint64_t{0}) + count.get<std::uint64_t>();
    }
  }
  return sums;
}

RunLooks run_looks(const Plan& plan, const std::vector<TaskLook>& looks) {
  RunLooks runs{{plan.name, {}}, {}};
  std::optional<TaskLook> failed;  // one of the shards that come before their run
  for (std::size_t i = 0; i < looks.size(); ++i) {
    if (plan.tasks[i].shard) {
      if (looks[i].status == TaskStatus::kFailed && !failed) {
        failed = looks[i];
        failed->shard = plan.tasks[i].shard->number;
      }
      continue;
    }
    const bool done = looks[i].status == TaskStatus::kDone;
    runs.plan.tasks.push_back(plan.tasks[i]);
    runs.looks.push_back(failed && !done ? *failed : looks[i]);
    failed.reset();
  }
  return runs;
}

OutcomeCounts::OutcomeCounts(const std::vector<TaskLook>& looks) {
  for (const TaskLook& look : looks) ++counts_.at(static_cast<std::size_t>(outcome_of(look)));
}

std::size_t OutcomeCounts::all() const {
  return std::accumulate(counts_.begin(), counts_.end(), std::size_t{0});
}

std::string OutcomeCounts::text() const {
  std::string text = counted(all(), "run") + ": ";
  for (const Outcome outcome : kOutcomes) {
    text += (outcome == kOutcomes.front() ? "" : ", ") + format_count(of(outcome)) + " " +
            words_of(outcome).word;
  }
  return text;
}

ordered_json OutcomeCounts::json() const {
  ordered_json out;
  for (const Outcome outcome : kOutcomes) out[words_of(outcome).name] = of(outcome);
  return out;
}

std::string ignored_words(const ordered_json& facts) {
  const ordered_json ignored = facts.value("ignored", ordered_json());
  if (ignored.is_null() || ignored["points"] == 0) return "";
  std::string text = counted(ignored["points"].get<std::uint64_t>(), "point") + " ignored";
  if (const ordered_json& colliding = ignored["colliding"]; !colliding.is_null()) {
    text += ", of which " + format_count(colliding.get<std::uint64_t>()) + " would collide";
  }
  return text;
}

namespace {

bool has_reason(const ordered_json& facts, Reason reason) {
  const ordered_json reasons = facts.value("reasons", ordered_json::array());
  return std::ranges::find(reasons, name_of(reason)) != reasons.end();
}

}  // namespace

bool is_in_doubt(const ordered_json& facts) { return has_reason(facts, Reason::kQuestionInDoubt); }

std::string open_words(const ordered_json& facts, const std::string& unit) {
  const auto doubts = facts.value("doubts", std::vector<std::string>());
  std::string text;
  for (const Reason reason :
       {Reason::kNear, Reason::kFew, Reason::kErrorsExceedMargin, Reason::kQuestionInDoubt}) {
    if (has_reason(facts, reason))
      text += (text.empty() ? "" : ", ") + reason_words(reason, doubts);
  }
  const ordered_json seen = facts.value("seen", ordered_json());
  if (!seen.is_null() && seen["listed_groups"] > 0) {
    const auto length = seen["not_scanned_length"].get<double>();
    text += (text.empty() ? "" : ", ") +
            (length > 0 ? "not scanned on " + format_brief(length) + " " + unit : "not scanned");
  }
  return text;
}

std::string floor_clause(const ordered_json& facts, const std::string& unit) {
  const ordered_json floor = facts.value("floor", ordered_json());
  if (floor.is_null()) return "";
  return format_count(floor["colliding"].get<std::uint64_t>()) + " below " +
         floor_words(floor, unit) + " not judged";
}

namespace {

std::string classified_clause(const ordered_json& facts) {
  ClassCounts counts;
  std::uint64_t points = 0;
  const ordered_json classes = facts.value("classes", ordered_json::object());
  for (const auto& [value, of_class] : classes.items()) {
    counts[static_cast<std::uint8_t>(std::stoul(value))] = of_class.get<std::uint64_t>();
    points += of_class.get<std::uint64_t>();
  }
  return classified_words(counts, points);
}

std::string ledger_clause(const ordered_json& facts) {
  const std::string words = ledger_words(facts.value("ledger", ordered_json()));
  return words.empty() ? "" : "ledger: " + words;
}

}  // namespace

std::string caveats_of(const ordered_json& facts, const std::string& unit) {
  std::string text;
  for (const std::string& one :
       {warning_words(facts), classified_clause(facts), ignored_words(facts),
        floor_clause(facts, unit), open_words(facts, unit), ledger_clause(facts)}) {
    if (!one.empty()) text += (text.empty() ? "" : "; ") + one;
  }
  return text;
}

namespace {

namespace fs = std::filesystem;

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

TaskStatus status_of(const std::optional<TaskState>& state, LockState lock) {
  if (lock == LockState::kHeld) return TaskStatus::kRunning;
  if (!state) return TaskStatus::kMissing;
  switch (state->ending) {
    case Ending::kFailed:
      return TaskStatus::kFailed;
    case Ending::kBegun:
      return lock == LockState::kUnknown ? TaskStatus::kBegun : TaskStatus::kInterrupted;
    default:
      return TaskStatus::kInterrupted;  // done, but outputs are missing or of another plan
  }
}

/// Whether the try finished its task, even if its inputs have changed since.
bool is_finished(const Task& task, const fs::path& campaign,
                 const std::optional<TaskState>& state) {
  if (!state || state->ending != Ending::kDone || state->question_id != task.question_id() ||
      state->outputs_id != task.outputs_id) {
    return false;
  }
  const fs::path folder = campaign / task.folder();
  std::error_code unknown;
  return std::ranges::all_of(
             task.outputs, [&](const auto& name) { return fs::exists(folder / name, unknown); }) &&
         has_result(task, campaign);
}

}  // namespace

const char* name_of(TaskStatus status) {
  constexpr const char* kNames[]{"done",     "running", "begun",  "interrupted",
                                 "outdated", "failed",  "missing"};
  return kNames[static_cast<std::size_t>(status)];
}

bool has_result(const Task& task, const fs::path& campaign) {
  return answers(campaign / task.folder() / task.result(), task.question);
}

bool is_done(const Task& task, const fs::path& campaign, const std::optional<TaskState>& state) {
  if (task.shard && has_result(run_of(task), campaign)) return true;
  return is_finished(task, campaign, state) && changed_since(state->inputs).empty();
}

TaskLook look_at(const Task& task, const fs::path& campaign) {
  const fs::path folder = campaign / task.folder();
  std::optional<TaskState> state = state_of(task, folder);
  for (;;) {
    if (is_done(task, campaign, state)) return {TaskStatus::kDone, state};
    const LockState lock = task_lock(folder);
    if (lock == LockState::kHeld) return {TaskStatus::kRunning, state};
    // The process that held the lock may have ended, or another may have begun, between the two
    // looks.
    std::optional<TaskState> again = state_of(task, folder);
    if (again == state) {
      TaskLook look{status_of(state, lock), state};
      if (is_finished(task, campaign, state)) {
        look.status = TaskStatus::kOutdated;
        look.changed = changed_since(state->inputs);
      }
      return look;
    }
    state = std::move(again);
  }
}

bool may_succeed(const TaskLook& look) {
  if (look.status != TaskStatus::kFailed) return true;
  return look.state->exit_code == kResource || look.state->inputs_changed;
}

namespace {

using nlohmann::ordered_json;

constexpr const char* kStateName = "state.json";
constexpr std::array kEndings{"begun", "done", "interrupted", "failed"};

Ending ending_of(const std::string& name) {
  for (std::size_t i = 0; i < kEndings.size(); ++i) {
    if (name == kEndings[i]) return static_cast<Ending>(i);
  }
  return Ending::kBegun;
}

ordered_json place_of(const ordered_json& place) {
  if (place.is_null()) return nullptr;
  ordered_json out{{"pose", place.at("pose")}, {"chainage", place.at("chainage")}};
  if (place.contains("distance")) out["distance"] = place.at("distance");
  return out;
}

/// The counts of ignored points; null where the query ignores nothing.
ordered_json ignored_of(const ordered_json& ignored) {
  if (ignored.at("classes").empty() && ignored.at("boxes").empty()) return nullptr;
  return {{"points", ignored.at("points")},
          {"colliding", ignored.value("colliding", ordered_json())}};
}

ordered_json json_of(const std::vector<InputStamp>& stamps) {
  ordered_json out = ordered_json::array();
  for (const InputStamp& stamp : stamps) {
    out.push_back({{"what", stamp.what},
                   {"file", stamp.file},
                   {"bytes", stamp.bytes},
                   {"modified", stamp.modified}});
  }
  return out;
}

std::vector<InputStamp> stamps_in(const ordered_json& list) {
  std::vector<InputStamp> stamps;
  for (const ordered_json& one : list) {
    InputStamp& stamp = stamps.emplace_back();
    one.at("what").get_to(stamp.what);
    one.at("file").get_to(stamp.file);
    one.at("bytes").get_to(stamp.bytes);
    one.at("modified").get_to(stamp.modified);
  }
  return stamps;
}

}  // namespace

std::optional<TaskState> read_state(const std::filesystem::path& folder) {
  std::error_code unknown;
  if (!std::filesystem::exists(folder / kStateName, unknown)) return std::nullopt;
  try {
    const ordered_json json = parse_json(text_of_file(folder / kStateName));
    TaskState state;
    state.ending = ending_of(json.at("state").get<std::string>());
    json.at("question_id").get_to(state.question_id);
    json.at("outputs_id").get_to(state.outputs_id);
    json.at("exit_code").get_to(state.exit_code);
    json.at("message").get_to(state.message);
    json.at("tries").get_to(state.tries);
    json.at("seconds").get_to(state.seconds);
    json.at("host").get_to(state.host);
    json.at("time").get_to(state.time);
    state.inputs_changed = json.at("inputs_changed");
    state.inputs = stamps_in(json.at("inputs"));
    state.facts = json.at("facts");
    return state;
  } catch (const JsonError&) {
    return std::nullopt;
  } catch (const ordered_json::exception&) {
    return std::nullopt;
  } catch (const ResourceError&) {
    return std::nullopt;
  }
}

void write_state(const std::filesystem::path& folder, const TaskState& state) {
  const ordered_json json{{"state", kEndings.at(static_cast<std::size_t>(state.ending))},
                          {"exit_code", state.exit_code},
                          {"message", state.message},
                          {"tries", state.tries},
                          {"seconds", state.seconds},
                          {"host", state.host},
                          {"time", state.time},
                          {"question_id", state.question_id},
                          {"outputs_id", state.outputs_id},
                          {"inputs_changed", state.inputs_changed},
                          {"inputs", json_of(state.inputs)},
                          {"facts", state.facts}};
  replace_file(folder / kStateName, indented_text(json, 1));
}

namespace {

/// Takes what the conflicts as JSON say of the ledger.
ordered_json ledger_facts(const fs::path& conflicts) {
  try {
    const ordered_json all = parse_json(text_of_file(conflicts));
    ordered_json out{{"conflicts", all.at("conflict_count")},
                     {"accepted_conflicts", all.at("ledger").at("accepted_conflicts")},
                     {"outside", all.at("ledger").at("outside").at("verdict")}};
    for (std::size_t i = 0; i < kLedgerStatuses; ++i) {
      const char* const status = name_of(static_cast<LedgerStatus>(i));
      out[status] = all.at("ledger").at(status);
    }
    return out;
  } catch (const JsonError& error) {
    throw ResourceError(conflicts.string() + ": is not what was written: " + error.what());
  } catch (const ordered_json::exception& error) {
    throw ResourceError(conflicts.string() + ": is not what was written: " + error.what());
  }
}

}  // namespace

void add_conflicts(ordered_json& facts, const fs::path& folder, const Task& task) {
  if (!task.ledger().empty()) facts["ledger"] = ledger_facts(folder / "conflicts.json");
  const std::vector<std::string>& outputs = task.outputs;
  const auto table = std::ranges::find(outputs, "conflicts.csv");
  if (table == outputs.end()) return;
  std::ifstream file(folder / *table);
  std::string line;
  if (!std::getline(file, line) || !line.starts_with("id,")) return;
  std::uint64_t count = 0;
  while (std::getline(file, line)) {
    if (!line.starts_with("0,")) ++count;  // groups that are too small to be listed have no number
  }
  facts["conflicts"] = {{"count", count}};
}

ordered_json task_facts(const std::filesystem::path& run_json) {
  try {
    const ordered_json run = parse_json(text_of_file(run_json));
    ordered_json warnings = ordered_json::array(), texts = ordered_json::array();
    for (const auto& warning : run.at("warnings")) {
      warnings.push_back(warning.at("code"));
      texts.push_back(warning.at("message"));
    }
    const ordered_json& profile = run.at("least_profile");
    ordered_json facts{{"verdict", run.at("verdict")},
                       {"reasons", run.value("reasons", ordered_json::array())},
                       {"doubts", run.value("doubts", ordered_json::array())},
                       {"colliding_points", run.at("colliding_points")},
                       {"ignored", ignored_of(run.at("ignored"))},
                       {"floor", run.value("floor", ordered_json())},
                       {"least", place_of(profile.is_null() ? run.at("least_clearance") : profile)},
                       {"least_side", run.value("least_side", ordered_json())},
                       {"first", place_of(run.at("first_place"))},
                       {"warnings", std::move(warnings)},
                       {"warning_texts", std::move(texts)}};
    if (const ordered_json seen = run.value("seen", ordered_json()); !seen.is_null()) {
      facts["seen"] = seen;
    }
    if (run.contains("classes")) facts["classes"] = run["classes"];
    return facts;
  } catch (const JsonError& error) {
    throw ResourceError(run_json.string() + ": is not what the run printed: " + error.what());
  } catch (const ordered_json::exception& error) {
    throw ResourceError(run_json.string() + ": is not what the run printed: " + error.what());
  }
}

}  // namespace clearway::campaign
