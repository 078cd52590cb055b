#include <fcntl.h>
#include <fmt/chrono.h>
#include <signal.h>
#include <spdlog/spdlog.h>
#include <sys/prctl.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <deque>
#include <exception>
#include <filesystem>
#include <list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "campaign/outcome.hpp"
#include "campaign/task_state.hpp"
#include "clearway/error.hpp"
#include "cli/campaign/commands.hpp"
#include "cli/clearway_program.hpp"
#include "cli/support/inherited_store.hpp"
#include "cli/support/program.hpp"
#include "core/util/stopwatch.hpp"
#include "io/files/file.hpp"
#include "io/files/input_error.hpp"
#include "io/files/text_lines.hpp"
#include "io/result/journal.hpp"

namespace clearway::tool {
namespace {

namespace fs = std::filesystem;
using campaign::Command;
using campaign::Status;
using campaign::Task;
using campaign::TaskState;

/// Added to the number of the signal that ended a process, to make an exit code as a shell does.
constexpr int kSignalled = 128;

File locked_task(const Task& task, const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) throw system_failure(folder.string() + ": cannot create", failed.value());
  const fs::path path = folder / campaign::kLockName;
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) throw system_failure(path.string() + ": cannot create", errno);
  File lock = File::adopt(descriptor, path.string());
  if (!lock_whole(lock)) throw ResourceError(task.name() + ": another process is at work on it");
  return lock;
}

void remove_if_there(const fs::path& path) {
  std::error_code failed;
  fs::remove(path, failed);
  if (failed) throw ResourceError(path.string() + ": cannot remove: " + failed.message());
}

/// Cuts a log that many tries have made long to its end.
void cut_log(const fs::path& log) {
  constexpr std::uintmax_t kMostBytes = 1 << 20, kKeptBytes = 1 << 16;
  std::error_code unknown;
  const std::uintmax_t bytes = fs::file_size(log, unknown);
  if (unknown || bytes <= kMostBytes) return;
  const std::string text = text_of_file(log);
  replace_file(log, std::string_view(text).substr(text.size() - kKeptBytes));
}

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

std::string time_in_utc() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now));
}

/// The locked folder of a task that this process works on, and the state that is written there.
class TaskFolder {
 public:
  /// Makes the folder and takes its lock, which is held as long as the object lives; removes what
  /// earlier tries left of other questions and inputs. Throws ResourceError where another process
  /// works on the task, InputError where the file of the result is damaged.
  TaskFolder(const Task& task, const fs::path& campaign)
      : task_(task), path_(campaign / task.folder()), lock_(locked_task(task, path_)) {
    const auto earlier = campaign::read_state(path_);
    done_ = campaign::is_done(task, campaign, earlier);
    if (done_) return;
    state_.question_id = task.question_id();
    state_.outputs_id = task.outputs_id;
    state_.inputs = campaign::stamps_of(task);
    state_.host = host_name();
    state_.time = time_in_utc();
    remove_others(earlier);
    ++state_.tries;
    campaign::write_state(path_, state_);
    cut_log(log());
  }

  const Task& task() const { return task_; }
  const fs::path& path() const { return path_; }
  const File& lock() const { return lock_; }
  /// Whether another process finished the task before the lock was taken, so that nothing is to be
  /// done.
  bool is_done() const { return done_; }
  fs::path log() const { return path_ / "log.txt"; }

  /// To be called before each command, so that errors in the log can be distinguished from those of
  /// earlier commands. number: from 0.
  void begin_command(std::size_t number) {
    command_ = number;
    std::error_code unknown;
    const std::uintmax_t bytes = fs::file_size(log(), unknown);
    log_begin_ = unknown ? 0 : bytes;
  }
  std::size_t command() const { return command_; }

  /// Writes how the try ended, for status and report, and returns the state as written. code: an
  /// exit code, or kSignalled plus the signal that killed.
  const TaskState& end(int code) {
    state_.exit_code = code;
    state_.seconds = time_.seconds();
    state_.time = time_in_utc();
    state_.ending = code == kDone          ? Status::kDone
                    : code == kInterrupted ? Status::kInterrupted
                                           : Status::kFailed;
    if (code == kDone && is_answered()) {
      state_.facts = campaign::task_facts(task_, path_);
    } else if (code == kDone) {
      refuse_changed_inputs("");
    } else if (code > kSignalled) {
      state_.message = "killed by signal " + std::to_string(code - kSignalled);
    } else {
      state_.message = last_error();
      // A run that is done again refuses its own result where that answers the planned question and
      // the present inputs ask another one.
      const bool is_run = task_.commands[command_][0] == "run";
      if (code == kWrongUsage && is_run && is_answered()) {
        refuse_changed_inputs(" (" + state_.message + ")");
      }
    }
    if (code == kSignalled + SIGKILL) {  // the system kills so where memory has run out
      state_.exit_code = kResource;
      state_.message += ", as where memory runs out";
    }
    campaign::write_state(path_, state_);
    return state_;
  }

 private:
  bool is_answered() const { return campaign::question_in(result()) == task_.question; }
  fs::path result() const { return path_ / task_.result(); }

  /// Removes what an earlier try made of another question, or from inputs other than the planned
  /// ones, which may have been put back since, so nothing else shows it. Whether a journal belongs
  /// to another store only a run can find out, so the journal of a try that failed for its inputs
  /// is removed too. Refuses a result that is damaged.
  void remove_others(const std::optional<TaskState>& earlier) {
    const Json found = campaign::question_in(result());
    const fs::path journal = journal_of(result());
    const bool is_other = found != task_.question;
    const bool asked_other = earlier && earlier->question_id != state_.question_id;
    const bool refused = earlier && earlier->ending == Status::kFailed &&
                         (earlier->exit_code == kWrongUsage || earlier->exit_code == kBadInput);
    if (asked_other) {
      for (const std::string& output : task_.outputs) remove_if_there(path_ / output);
    } else if (earlier) {
      state_.tries = earlier->tries;
    }
    if (is_other && (asked_other || !found.is_null())) remove_if_there(result());
    if (refused || (is_other && asked_other) ||
        campaign::is_journal_of_others(journal, task_.question)) {
      remove_if_there(journal);
    }
    std::error_code unknown;
    if (!is_other || !fs::exists(result(), unknown)) return;
    state_.ending = Status::kFailed;
    state_.exit_code = kBadInput;
    state_.message =
        result().string() + ": is damaged or no result; remove it, and run the task again";
    campaign::write_state(path_, state_);
    throw InputError(state_.message);
  }

  /// Fails the try because the inputs have changed since they were planned.
  void refuse_changed_inputs(const std::string& details) {
    state_.ending = Status::kFailed;
    state_.exit_code = kBadInput;
    state_.inputs_changed = true;
    state_.message =
        "an input has changed since it was planned: put it back and run the task again, or plan "
        "again with --force" +
        details;
  }

  /// What the last line of the command's log says that is an error.
  std::string last_error() const {
    std::error_code unknown;
    if (!fs::exists(log(), unknown)) return "";
    constexpr std::string_view kError = "error: ";
    const std::string text = text_of_file(log());
    std::string error;
    std::string_view rest = std::string_view(text).substr(std::min(log_begin_, text.size()));
    while (!rest.empty()) {
      const std::string_view line = take_line(rest);
      if (line.starts_with(kError)) error = line.substr(kError.size());
    }
    return error;
  }

  const Task& task_;
  fs::path path_;
  File lock_;
  bool done_ = false;
  TaskState state_;
  std::size_t command_ = 0, log_begin_ = 0;
  Stopwatch time_;
};

/// A command of this program that is to run in a process of its own.
struct ChildCommand {
  std::vector<std::string> words;  ///< the command line, without the program's name
  fs::path folder;                 ///< the folder that the command works in
  fs::path log;                    ///< appended to: standard error, and output if `output` is empty
  fs::path output;                 ///< replaced by standard output; empty: that goes to the log
  std::vector<int> foreign;        ///< the caller's descriptors that the child closes
  sigset_t signals{};              ///< the signal mask of the child
};

/// Opens `path` as `descriptor`. False where that fails.
bool open_as(int descriptor, const char* path, int flags) {
  const int opened = ::open(path, flags | O_CLOEXEC, 0666);
  if (opened < 0) return false;
  if (opened == descriptor) return true;
  const bool done = ::dup2(opened, descriptor) >= 0;
  ::close(opened);
  return done;
}

bool take_place(const ChildCommand& command, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) return false;  // the parent died before prctl
  ::setpgid(0, 0);
  for (const int descriptor : command.foreign) ::close(descriptor);
  constexpr int kAppend = O_WRONLY | O_CREAT | O_APPEND, kReplace = O_WRONLY | O_CREAT | O_TRUNC;
  const bool to_log = command.output.empty();
  return open_as(STDIN_FILENO, "/dev/null", O_RDONLY) &&
         open_as(STDERR_FILENO, command.log.c_str(), kAppend) &&
         open_as(STDOUT_FILENO, to_log ? command.log.c_str() : command.output.c_str(),
                 to_log ? kAppend : kReplace) &&
         ::chdir(command.folder.c_str()) == 0 &&
         ::sigprocmask(SIG_SETMASK, &command.signals, nullptr) == 0;
}

int call_program(const ChildCommand& command) {
  std::vector<std::string> words{"clearway"};
  words.insert(words.end(), command.words.begin(), command.words.end());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return run_clearway(static_cast<int>(words.size()), pointers.data());
}

/// Forks a child that calls the program's entry, without loading the program again, and returns its
/// process id. The calling process must have one thread. The child is killed when the caller dies,
/// and has a process group of its own, so that signals of the terminal reach the caller alone.
/// Throws ResourceError.
pid_t start_child(const ChildCommand& command) {
  std::fflush(nullptr);
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child < 0) {
    throw ResourceError("cannot start a process: " + std::string(std::strerror(errno)));
  }
  if (child > 0) return child;
  int code = kResource;
  try {
    if (take_place(command, parent)) code = call_program(command);
  } catch (const std::exception&) {  // no exception of the child may reach the caller's code
    code = kResource;
  }
  std::fflush(nullptr);
  ::_exit(code);
}

bool ignores(int signal) {
  struct sigaction action {};
  return ::sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

int code_of(int status) {
  if (WIFEXITED(status)) return WEXITSTATUS(status);
  const int signal = WTERMSIG(status);
  return signal == SIGTERM || signal == SIGINT ? int{kInterrupted} : kSignalled + signal;
}

/// The command line with --threads, where several tasks share the cores and the campaign does not
/// say how many threads they have.
Command with_threads(Command words, std::size_t jobs) {
  const bool said = std::ranges::any_of(
      words, [](const std::string& word) { return word.starts_with("--threads="); });
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  if (said || jobs == 1) return words;
  words.push_back("--threads=" + std::to_string(std::max<std::size_t>(1, cores / jobs)));
  return words;
}

class TaskQueue {
 public:
  TaskQueue(const campaign::Plan& plan, const fs::path& campaign, int jobs, bool tries_again)
      : plan_(plan),
        campaign_(campaign),
        jobs_(static_cast<std::size_t>(jobs)),
        tries_again_(tries_again) {
    for (const Task& task : plan.tasks) {
      waiting_.push_back(&task);
      unfinished_.insert(task.number);
    }
  }

  int run() {
    block_signals();
    while (!working_.empty() || (!waiting_.empty() && !stopping_)) {
      const auto next = working_.size() == jobs_ || stopping_ ? waiting_.end() : next_task();
      siginfo_t info{};
      if (next == waiting_.end()) {
        handle(::sigwaitinfo(&waited_, &info));
        continue;
      }
      const Task& task = **next;
      waiting_.erase(next);
      begin(task);
      const timespec none{};
      handle(::sigtimedwait(&waited_, &info, &none));
    }
    return interrupted_ || (stopping_ && !waiting_.empty()) ? int{kInterrupted} : code_;
  }

 private:
  struct Work {
    TaskFolder folder;
    pid_t child = 0;
  };
  using Waiting = std::deque<const Task*>;

  /// Blocks the signals that the queue waits for, so that none is lost between two waits.
  void block_signals() {
    ::signal(SIGCHLD, SIG_DFL);
    ::sigemptyset(&waited_);
    ::sigaddset(&waited_, SIGCHLD);
    for (const int signal : {SIGINT, SIGTERM}) {
      if (!ignores(signal)) ::sigaddset(&waited_, signal);
    }
    ::sigprocmask(SIG_BLOCK, &waited_, &before_);
  }

  /// The first waiting task that needs no other unfinished task of this queue. The tasks before a
  /// merge are its shards.
  Waiting::iterator next_task() {
    return std::ranges::find_if(waiting_, [this](const Task* task) {
      const auto first = unfinished_.lower_bound(task->number - task->shards);
      return first == unfinished_.end() || *first >= task->number;
    });
  }

  /// Throws UsageError where a shard that the merge `task` needs is not done. It is wrong usage to
  /// ask for the merge too early, because trying again does not help by itself.
  void check_shards(const Task& task) const {
    for (std::uint32_t number = 1; number <= task.shards; ++number) {
      const Task shard = campaign::shard_of(task, number);
      const auto state = campaign::read_state(campaign_ / shard.folder());
      if (campaign::is_done(shard, campaign_, state)) continue;
      throw UsageError(task.name() + ": waits for " + shard.name() + ", which is not done");
    }
  }

  void begin(const Task& task) {
    try {
      const auto earlier = campaign::read_state(campaign_ / task.folder());
      if (campaign::is_done(task, campaign_, earlier)) return end(task);
      if (earlier && earlier->ending == Status::kDone) {
        const std::string changed = campaign::changed_since(earlier->inputs);
        if (!changed.empty()) spdlog::info("{}: {}; it runs again", task.name(), changed);
      }
      // A merge that already has its result needs no parts.
      const bool merged = task.shards > 0 && campaign::has_result(task, campaign_);
      if (!merged) check_shards(task);
      Work work{TaskFolder(task, campaign_)};
      if (work.folder.is_done()) return end(task);
      start_command(work, merged ? 1 : 0);
      working_.push_back(std::move(work));
    } catch (const UsageError& error) {
      fail(task, kWrongUsage, error.what());
    } catch (const InputError& error) {
      fail(task, kBadInput, error.what());
    } catch (const ResourceError& error) {
      fail(task, kResource, error.what());
    }
  }

  void start_command(Work& work, std::size_t number) {
    TaskFolder& folder = work.folder;
    folder.begin_command(number);
    const Command& words = folder.task().commands[number];
    const std::string output = campaign::output_of(words);
    ChildCommand command{.words = with_threads(words, jobs_),
                         .folder = folder.path(),
                         .log = folder.log(),
                         .output = output.empty() ? fs::path() : folder.path() / output,
                         .foreign = {},
                         .signals = before_};
    for (const Work& other : working_) {
      if (&other != &work) command.foreign.push_back(other.folder.lock().descriptor());
    }
    // Further tasks most often ask about the same store.
    if (unfinished_.size() > 1) keep_store(folder.task().inputs.front().file);
    work.child = start_child(command);
  }

  /// Handles a signal that is pending; none for a negative number.
  void handle(int signal) {
    if (signal == SIGINT || signal == SIGTERM) {
      stopping_ = true;
      for (const Work& work : working_) ::kill(work.child, SIGTERM);
    }
    for (auto work = working_.begin(); signal > 0 && work != working_.end();) {
      const auto one = work++;
      int status = 0;
      if (::waitpid(one->child, &status, WNOHANG) == one->child) end_command(one, code_of(status));
    }
  }

  void end_command(std::list<Work>::iterator work, int code) {
    TaskFolder& folder = work->folder;
    try {
      const std::size_t next = folder.command() + 1;
      const bool more = code == kDone && next < folder.task().commands.size();
      if (more && !stopping_) return start_command(*work, next);
      end_task(folder, more ? int{kInterrupted} : code);
    } catch (const ResourceError& error) {
      fail(folder.task(), kResource, error.what());
    }
    working_.erase(work);
  }

  void end_task(TaskFolder& folder, int code) {
    const Task& task = folder.task();
    const TaskState& state = folder.end(code);
    if (state.ending == Status::kDone) {
      end(task);
      const std::string caveats = campaign::caveats_of(state.facts, task.unit);
      spdlog::info("{} of {}: {}: {}{}{}, {:.2f} s", ended_, plan_.tasks.size(), task.name(),
                   state.facts["verdict"].get<std::string>(), caveats.empty() ? "" : "; ", caveats,
                   state.seconds);
    } else if (is_tried_again(task, state.exit_code)) {
      spdlog::warn("{}: exit code {}: {}; is tried again", task.name(), state.exit_code,
                   state.message);
      waiting_.push_back(&task);
    } else {
      fail(task, state.exit_code, state.message);
    }
  }

  void end(const Task& task) {
    ++ended_;
    unfinished_.erase(task.number);
  }

  bool is_tried_again(const Task& task, int code) {
    constexpr int kMostFailures = 3;
    if (!tries_again_ || stopping_) return false;
    return code == kInterrupted || (code == kResource && ++failures_[&task] < kMostFailures);
  }

  void fail(const Task& task, int code, const std::string& message) {
    end(task);
    if (code == kInterrupted) {
      interrupted_ = true;
      return spdlog::info("{} of {}: {}: interrupted", ended_, plan_.tasks.size(), task.name());
    }
    code_ = more_urgent(code_, code);
    spdlog::error("{} of {}: {}: exit code {}: {}", ended_, plan_.tasks.size(), task.name(), code,
                  message);
  }

  const campaign::Plan& plan_;
  fs::path campaign_;
  std::size_t jobs_;
  Waiting waiting_;
  std::set<std::size_t> unfinished_;  ///< numbers of the tasks that wait or are worked on
  std::list<Work> working_;
  std::map<const Task*, int> failures_;
  std::size_t ended_ = 0;
  int code_ = 0;
  bool tries_again_, stopping_ = false, interrupted_ = false;
  sigset_t before_{}, waited_{};
};

}  // namespace

int do_tasks(const campaign::Plan& plan, const fs::path& campaign, int jobs, bool tries_again) {
  return TaskQueue(plan, campaign, jobs, tries_again).run();
}

}  // namespace clearway::tool
