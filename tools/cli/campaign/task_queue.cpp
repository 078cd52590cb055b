#include "cli/campaign/task_queue.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spdlog/spdlog.h>
#include <sys/prctl.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "campaign/task_state.hpp"
#include "clearway/error.hpp"
#include "cli/clearway_program.hpp"
#include "cli/support/inherited_store.hpp"
#include "cli/support/program.hpp"
#include "io/store/store_reader.hpp"
#include "search/device_estimate.hpp"

namespace clearway::tool {

std::uint32_t RunEstimate::shards(const RunOptions& run,
                                  const std::vector<EstimatedModel>& models) {
  if (!is_asked_for()) return 1;
  if (!store_ || store_->path() != run.environment) store_.emplace(run.environment);
  std::vector<Workload> work;
  for (const auto& [box, points, poses] : models) {
    work.push_back(workload_of(store_->reader(), run.query, box, points, poses));
  }
  const DeviceEstimate seconds = estimate_devices(work, run.query, std::max(run.search.threads, 1));
  const double needed = run.search.device == Device::kCuda ? seconds.cuda : seconds.cpu;
  return static_cast<std::uint32_t>(
      std::clamp(std::ceil(needed / shard_seconds_), 1.0, double{Shard::kMost}));
}

namespace {

/// A command of this program that is to run in a process of its own.
struct ChildCommand {
  std::vector<std::string> words;  ///< the command line, without the program's name
  std::filesystem::path folder;    ///< the folder that the command works in
  std::filesystem::path log;       ///< appended to: standard error, and output if `output` is empty
  std::filesystem::path output;    ///< replaced by standard output; empty: that goes to the log
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

constexpr int kMostFailures = 3;  ///< a task that fails with kResource is tried twice more

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
std::vector<std::string> with_threads(std::vector<std::string> words, std::size_t jobs) {
  const bool said = std::ranges::any_of(
      words, [](const std::string& word) { return word.starts_with("--threads="); });
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  if (said || jobs == 1) return words;
  words.push_back("--threads=" + std::to_string(std::max<std::size_t>(1, cores / jobs)));
  return words;
}

}  // namespace

TaskQueue::TaskQueue(const campaign::Plan& plan, std::filesystem::path campaign, int jobs,
                     bool tries_again)
    : plan_(plan),
      campaign_(std::move(campaign)),
      jobs_(static_cast<std::size_t>(jobs)),
      tries_again_(tries_again) {
  for (const campaign::Task& task : plan.tasks) {
    waiting_.push_back(&task);
    unfinished_.insert(task.number);
  }
}

int TaskQueue::run() {
  block_signals();
  while (!working_.empty() || (!waiting_.empty() && !stopping_)) {
    const auto next = working_.size() == jobs_ || stopping_ ? waiting_.end() : next_task();
    if (next == waiting_.end()) {
      wait();
      continue;
    }
    const campaign::Task& task = **next;
    waiting_.erase(next);
    begin(task);
    look();
  }
  return interrupted_ || (stopping_ && !waiting_.empty()) ? int{kInterrupted} : code_;
}

/// Blocks the signals that the queue waits for, so that none is lost between two looks.
void TaskQueue::block_signals() {
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
std::deque<const campaign::Task*>::iterator TaskQueue::next_task() {
  return std::ranges::find_if(waiting_, [this](const campaign::Task* task) {
    const auto first = unfinished_.lower_bound(task->number - task->shards);
    return first == unfinished_.end() || *first >= task->number;
  });
}

/// Throws UsageError where a shard that the merge `task` needs is not done. It is wrong usage to
/// ask for the merge too early, because trying again does not help by itself.
void TaskQueue::check_shards(const campaign::Task& task) const {
  for (std::uint32_t number = 1; number <= task.shards; ++number) {
    const campaign::Task shard = campaign::shard_of(task, number);
    const auto state = campaign::read_state(campaign_ / shard.folder());
    if (campaign::is_done(shard, campaign_, state)) continue;
    throw UsageError(task.name() + ": waits for " + shard.name() + ", which is not done");
  }
}

void TaskQueue::begin(const campaign::Task& task) {
  try {
    const auto earlier = campaign::read_state(campaign_ / task.folder());
    if (campaign::is_done(task, campaign_, earlier)) return end(task);
    if (earlier && earlier->ending == campaign::Ending::kDone) {
      const std::string changed = campaign::changed_since(earlier->inputs);
      if (!changed.empty()) spdlog::info("{}: {}; it runs again", task.name(), changed);
    }
    // A merge that already has its result needs no parts.
    const bool merged = task.shards > 0 && campaign::has_result(task, campaign_);
    if (!merged) check_shards(task);
    const auto work = working_.emplace(working_.end(), TaskFolder(task, campaign_));
    try {
      if (!work->folder.is_done()) return start_command(*work, merged ? 1 : 0);
      end(task);
      working_.erase(work);
    } catch (const ResourceError&) {
      working_.erase(work);
      throw;
    }
  } catch (const UsageError& error) {
    fail(task, kWrongUsage, error.what());
  } catch (const InputError& error) {
    fail(task, kBadInput, error.what());
  } catch (const ResourceError& error) {
    fail(task, kResource, error.what());
  }
}

void TaskQueue::start_command(Work& work, std::size_t number) {
  TaskFolder& folder = work.folder;
  folder.begin_command(number);
  const campaign::Command& words = folder.task().commands[number];
  ChildCommand command{.words = with_threads(words, jobs_),
                       .folder = folder.path(),
                       .log = folder.log(),
                       .output = words[0] == "run" ? folder.run_output() : std::filesystem::path(),
                       .foreign = {},
                       .signals = before_};
  for (const Work& other : working_) {
    if (&other != &work) command.foreign.push_back(other.folder.lock_descriptor());
  }
  // Further tasks most often ask about the same store.
  if (unfinished_.size() > 1) keep_store_of(words);
  work.child = start_child(command);
}

void TaskQueue::wait() {
  siginfo_t info{};
  const int signal = ::sigwaitinfo(&waited_, &info);
  handle(signal);
}

/// Heeds a pending signal, without waiting for one.
void TaskQueue::look() {
  siginfo_t info{};
  const timespec none{};
  handle(::sigtimedwait(&waited_, &info, &none));
}

void TaskQueue::handle(int signal) {
  if (signal == SIGINT || signal == SIGTERM) stop();
  if (signal > 0) reap();
}

void TaskQueue::stop() {
  stopping_ = true;
  for (const Work& work : working_) ::kill(work.child, SIGTERM);
}

void TaskQueue::reap() {
  for (auto work = working_.begin(); work != working_.end();) {
    const auto one = work++;
    int status = 0;
    if (::waitpid(one->child, &status, WNOHANG) == one->child) end_command(one, status);
  }
}

void TaskQueue::end_command(std::list<Work>::iterator work, int status) {
  TaskFolder& folder = work->folder;
  const campaign::Task& task = folder.task();
  const int code = code_of(status);
  try {
    const std::size_t next = folder.command() + 1;
    const bool more = code == kDone && next < task.commands.size();
    if (more && !stopping_) return start_command(*work, next);
    end_task(folder, more ? int{kInterrupted} : code);
  } catch (const ResourceError& error) {
    fail(task, kResource, error.what());
  }
  working_.erase(work);
}

void TaskQueue::end_task(TaskFolder& folder, int code) {
  const campaign::Task& task = folder.task();
  const campaign::TaskState& state = folder.end(code);
  if (state.ending == campaign::Ending::kDone) {
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

void TaskQueue::end(const campaign::Task& task) {
  ++ended_;
  unfinished_.erase(task.number);
}

bool TaskQueue::is_tried_again(const campaign::Task& task, int code) {
  if (!tries_again_ || stopping_) return false;
  return code == kInterrupted || (code == kResource && ++failures_[&task] < kMostFailures);
}

void TaskQueue::fail(const campaign::Task& task, int code, const std::string& message) {
  end(task);
  if (code == kInterrupted) {
    interrupted_ = true;
    return spdlog::info("{} of {}: {}: interrupted", ended_, plan_.tasks.size(), task.name());
  }
  code_ = more_urgent(code_, code);
  spdlog::error("{} of {}: {}: exit code {}: {}", ended_, plan_.tasks.size(), task.name(), code,
                message);
}

}  // namespace clearway::tool
