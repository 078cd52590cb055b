#include "clearway/bench/program.hpp"

#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <span>

#include "clearway/exit_code.hpp"
#include "clearway/signals.hpp"
#include "core/error.hpp"
#include "core/stopwatch.hpp"
#include "io/file.hpp"

namespace clearway::tool {
namespace {

File memory_file(const char* name) { return File::adopt(::memfd_create(name, MFD_CLOEXEC), name); }

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

/// Whether the process ends within that time; a signal to this one ends the wait too.
bool ends_within(pid_t process, double seconds) {
  const File handle =
      File::adopt(static_cast<int>(::syscall(SYS_pidfd_open, process, 0)), "process");
  pollfd ended{.fd = handle.descriptor(), .events = POLLIN, .revents = 0};
  return ::poll(&ended, 1, static_cast<int>(1e3 * seconds)) != 0;
}

}  // namespace

ProgramRun run_program(std::vector<std::string> arguments, double limit_seconds) {
  const std::string line = joined(arguments);
  arguments.insert(arguments.begin(), "clearway");
  std::vector<char*> words;
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  const File output = memory_file("standard output"), log = memory_file("standard error");
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, output.descriptor(), STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, log.descriptor(), STDERR_FILENO);
  pid_t child = 0;
  const Stopwatch wall;
  const int error =
      ::posix_spawn(&child, "/proc/self/exe", &actions, nullptr, words.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw ResourceError(line + ": cannot start: " + std::strerror(error));
  const bool timed_out = limit_seconds > 0 && !ends_within(child, limit_seconds);
  if (timed_out) ::kill(child, SIGTERM);
  int status = 0;
  struct rusage usage {};
  while (::wait4(child, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  ProgramRun run{.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1,
                 .timed_out = timed_out,
                 .output = text_of(output),
                 .log = text_of(log),
                 .wall_seconds = wall.seconds(),
                 .peak_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024};
  if (timed_out && !stop_requested()) return run;
  if (stop_requested() || run.exit_code == kInterrupted) throw Interrupted(line + ": interrupted");
  if (run.exit_code < 0) {
    throw ResourceError(line + ": ended by signal " + std::to_string(WTERMSIG(status)));
  }
  return run;
}

std::string output_of_program(const std::vector<std::string>& arguments) {
  ProgramRun run = run_program(arguments);
  if (run.exit_code != 0) throw ResourceError(joined(arguments) + ": " + run.log);
  return std::move(run.output);
}

}  // namespace clearway::tool
