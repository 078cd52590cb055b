#include "bench/measure/program.hpp"

#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <span>

#include "clearway/error.hpp"
#include "cli/support/console.hpp"
#include "cli/support/program.hpp"
#include "core/util/stopwatch.hpp"
#include "io/files/file.hpp"

namespace clearway::bench {
namespace {

/// Milliseconds between checks for a signal to this program and for the limit.
constexpr int kLookMilliseconds = 50;

/// The file of a descriptor that a system call gave. Throws ResourceError where the call failed.
File opened(int descriptor, const char* name) {
  if (descriptor < 0) throw ResourceError(std::string(name) + ": " + std::strerror(errno));
  return File::adopt(descriptor, name);
}

File memory_file(const char* name) { return opened(::memfd_create(name, MFD_CLOEXEC), name); }

std::string text_of(const File& file) {
  std::string text(file.size_bytes(), '\0');
  if (!text.empty()) file.read_at(0, std::as_writable_bytes(std::span(text)));
  return text;
}

std::string joined(const std::vector<std::string>& arguments) {
  std::string line = "clearway";
  for (const std::string& argument : arguments) line += " " + argument;
  return line;
}

/// Turns the child into the program at `path`, with these files as standard output and error. It is
/// asked to stop when its parent dies. Does not return.
[[noreturn]] void become_program(const char* path, char** words, int output, int log) {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::dup2(output, STDOUT_FILENO) >= 0 && ::dup2(log, STDERR_FILENO) >= 0) {
    ::execv(path, words);
  }
  ::_exit(kResource);
}

/// Waits until the process of `handle` ends, and asks it to stop once it exceeds the limit or this
/// program is to stop. Returns whether it exceeded the limit.
bool wait_within(pid_t process, const File& handle, double limit_seconds, const Stopwatch& wall) {
  pollfd ended{.fd = handle.descriptor(), .events = POLLIN, .revents = 0};
  for (;;) {
    if (::poll(&ended, 1, kLookMilliseconds) > 0) return false;
    const bool late = limit_seconds > 0 && wall.seconds() > limit_seconds;
    if (!late && !tool::stop_requested()) continue;
    ::kill(process, SIGTERM);
    return late;
  }
}

struct Ending {
  int status = 0;
  struct rusage usage {};
};

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

Ending reaped(pid_t process) {
  Ending ending;
  while (::wait4(process, &ending.status, 0, &ending.usage) < 0 && errno == EINTR) {
  }
  return ending;
}

}  // namespace

Program::Program(std::filesystem::path path) : path_(std::move(path)) {
  if (path_.empty())
    path_ = std::filesystem::read_symlink("/proc/self/exe").replace_filename("clearway");
  if (::access(path_.c_str(), X_OK) == 0) return;
  throw UsageError(path_.string() + ": is no program to be run; --program names another clearway");
}

ProgramRun Program::run(std::vector<std::string> arguments, double limit_seconds) const {
  const std::string line = joined(arguments);
  arguments.insert(arguments.begin(), "clearway");
  std::vector<char*> words;
  words.reserve(arguments.size() + 1);
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  const File output = memory_file("standard output"), log = memory_file("standard error");
  const Stopwatch wall;
  const pid_t child = ::fork();
  if (child < 0) throw ResourceError(line + ": cannot start: " + std::strerror(errno));
  if (child == 0)
    become_program(path_.c_str(), words.data(), output.descriptor(), log.descriptor());
  bool timed_out = false;
  try {
    const File handle = opened(static_cast<int>(::syscall(SYS_pidfd_open, child, 0)), "pidfd_open");
    timed_out = wait_within(child, handle, limit_seconds, wall);
  } catch (...) {
    ::kill(child, SIGTERM);
    reaped(child);
    throw;
  }
  const auto [status, usage] = reaped(child);
  ProgramRun run{.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1,
                 .timed_out = timed_out,
                 .output = text_of(output),
                 .log = text_of(log),
                 .wall_seconds = wall.seconds(),
                 .cpu_seconds = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime),
                 .peak_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024};
  if (tool::stop_requested()) throw Interrupted(line + ": interrupted");
  if (timed_out) return run;
  if (run.exit_code == kInterrupted) throw Interrupted(line + ": interrupted");
  if (run.exit_code < 0) {
    throw ResourceError(line + ": ended by signal " + std::to_string(WTERMSIG(status)));
  }
  return run;
}

std::string Program::output_of(const std::vector<std::string>& arguments) const {
  ProgramRun done = run(arguments);
  if (done.exit_code != 0) throw ResourceError(joined(arguments) + ": " + done.log);
  return std::move(done.output);
}

}  // namespace clearway::bench
