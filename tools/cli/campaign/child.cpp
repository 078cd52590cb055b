#include "cli/campaign/child.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>

#include "clearway/error.hpp"
#include "cli/clearway_program.hpp"
#include "cli/support/exit_code.hpp"

namespace clearway::tool {
namespace {

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

}  // namespace

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

}  // namespace clearway::tool
