#include "cli/campaign/task_folder.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>

#include "campaign/plan.hpp"
#include "clearway/error.hpp"
#include "cli/support/program.hpp"
#include "io/files/file.hpp"
#include "io/files/input_error.hpp"
#include "io/result/journal.hpp"

namespace clearway::tool {
namespace {

namespace fs = std::filesystem;
using campaign::Ending;

constexpr std::uintmax_t kMostLogBytes = 1 << 20, kKeptLogBytes = 1 << 16;

File locked_task(const campaign::Task& task, const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) throw system_failure(folder.string() + ": cannot create", failed.value());
  const fs::path path = folder / campaign::kLockName;
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    throw system_failure(path.string() + ": cannot create", errno);
  }
  File lock = File::adopt(descriptor, path.string());
  if (!lock_whole(lock)) {
    throw ResourceError(task.name() + ": another process is at work on it");
  }
  return lock;
}

void remove_if_there(const fs::path& path) {
  std::error_code failed;
  fs::remove(path, failed);
  if (failed) throw ResourceError(path.string() + ": cannot remove: " + failed.message());
}

/// Cuts a log that many tries have made long to its end.
void cut_log(const fs::path& log) {
  std::error_code unknown;
  const std::uintmax_t bytes = fs::file_size(log, unknown);
  if (unknown || bytes <= kMostLogBytes) return;
  const std::string text = text_of_file(log);
  replace_file(log, std::string_view(text).substr(text.size() - kKeptLogBytes));
}

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

std::string time_in_utc() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now));
}

}  // namespace

TaskFolder::TaskFolder(const campaign::Task& task, const fs::path& campaign)
    : task_(task), path_(campaign / task.folder()), lock_(locked_task(task, path_)) {
  const auto earlier = campaign::read_state(path_);
  done_ = campaign::is_done(task, campaign, earlier);
  if (done_) return;
  if (earlier && earlier->question_id == task.question_id()) {
    state_.tries = earlier->tries;
  } else if (earlier) {
    remove_others();
  }
  state_.question_id = task.question_id();
  state_.outputs_id = task.outputs_id;
  state_.inputs = campaign::stamps_of(task);
  state_.host = host_name();
  state_.time = time_in_utc();
  remove_of_other_inputs(earlier);
  refuse_damaged_result();
  ++state_.tries;
  campaign::write_state(path_, state_);
  cut_log(log());
}

/// Removes a result or journal that an earlier try made from inputs other than the planned ones;
/// the inputs may have been put back since, so nothing else shows it. Whether a journal belongs to
/// another store only a run can find out, so the journal of a try that failed for its inputs is
/// removed too.
void TaskFolder::remove_of_other_inputs(const std::optional<campaign::TaskState>& earlier) {
  const fs::path result = path_ / task_.result(), journal = journal_of(result);
  if (campaign::answers_another(result, task_.question)) remove_if_there(result);
  const bool refused = earlier && earlier->ending == Ending::kFailed &&
                       (earlier->exit_code == kWrongUsage || earlier->exit_code == kBadInput);
  if (refused || campaign::is_journal_of_others(journal, task_.question)) remove_if_there(journal);
}

void TaskFolder::refuse_damaged_result() {
  std::error_code unknown;
  const fs::path result = path_ / task_.result();
  if (!fs::exists(result, unknown) || campaign::answers(result, task_.question)) return;
  state_.ending = Ending::kFailed;
  state_.exit_code = kBadInput;
  state_.message = result.string() + ": is damaged or no result; remove it, and run the task again";
  campaign::write_state(path_, state_);
  throw InputError(state_.message);
}

void TaskFolder::remove_others() {
  if (!campaign::answers(path_ / task_.result(), task_.question)) {
    remove_if_there(path_ / task_.result());
    remove_if_there(journal_of(path_ / task_.result()));
  }
  for (const std::string& output : task_.outputs) remove_if_there(path_ / output);
}

void TaskFolder::begin_command(std::size_t number) {
  command_ = number;
  std::error_code unknown;
  const std::uintmax_t bytes = fs::file_size(log(), unknown);
  log_begin_ = unknown ? 0 : bytes;
}

const campaign::TaskState& TaskFolder::end(int code) {
  state_.exit_code = code;
  state_.seconds = time_.seconds();
  state_.time = time_in_utc();
  state_.ending = code == kDone          ? Ending::kDone
                  : code == kInterrupted ? Ending::kInterrupted
                                         : Ending::kFailed;
  if (code == kDone) {
    judge_result();
  } else {
    state_.message =
        code > kSignalled ? "killed by signal " + std::to_string(code - kSignalled) : last_error();
    judge_refusal(code);
    if (code == kSignalled + SIGKILL) {  // the system kills so where memory has run out
      state_.exit_code = kResource;
      state_.message += ", as where memory runs out";
    }
  }
  campaign::write_state(path_, state_);
  return state_;
}

/// Takes the facts of the result, or fails the try where the result answers another question
/// because the inputs have changed since they were planned.
void TaskFolder::judge_result() {
  if (campaign::answers(path_ / task_.result(), task_.question)) {
    state_.facts = campaign::task_facts(run_output());
    campaign::add_conflicts(state_.facts, path_, task_);
    return;
  }
  state_.ending = Ending::kFailed;
  refuse_changed_inputs("");
}

/// Recognises changed inputs behind a refusal: a run that is done again refuses its own result
/// where that answers the planned question and the present inputs ask another one.
void TaskFolder::judge_refusal(int code) {
  const bool runs = task_.commands[command_][0] == "run";
  if (code != kWrongUsage || !runs) return;
  if (!campaign::answers(path_ / task_.result(), task_.question)) return;
  refuse_changed_inputs(" (" + state_.message + ")");
}

void TaskFolder::refuse_changed_inputs(const std::string& details) {
  state_.exit_code = kBadInput;
  state_.inputs_changed = true;
  state_.message =
      "an input has changed since it was planned: put it back and run the task again, or plan "
      "again with --force" +
      details;
}

std::string TaskFolder::last_error() const {
  std::error_code unknown;
  if (!fs::exists(log(), unknown)) return "";
  const std::string text = text_of_file(log());
  const std::string_view own = std::string_view(text).substr(std::min(log_begin_, text.size()));
  constexpr std::string_view kError = "error: ";
  std::size_t at = own.rfind(kError);
  while (at != std::string_view::npos && at > 0 && own[at - 1] != '\n')
    at = own.rfind(kError, at - 1);
  if (at == std::string_view::npos) return "";
  const std::string_view line = own.substr(at + kError.size());
  return std::string(line.substr(0, line.find('\n')));
}

}  // namespace clearway::tool
