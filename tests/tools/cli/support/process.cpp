#include "tools/cli/support/process.hpp"

#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <stdexcept>
#include <utility>

#include "support/result_fixture.hpp"

namespace clearway::test {

Process::Process(const std::string& arguments, std::filesystem::path log) : log_(std::move(log)) {
  std::string command = std::string("exec '") + CLEARWAY_PROGRAM + "' " + arguments + " >'" +
                        log_.string() + "' 2>&1";
  char sh[] = "/bin/sh", c[] = "-c";
  char* words[] = {sh, c, command.data(), nullptr};
  if (::posix_spawn(&pid_, sh, nullptr, nullptr, words, environ) != 0) {
    throw std::runtime_error("cannot start the program");
  }
}

Process::~Process() {
  if (pid_ > 0) {
    ::kill(pid_, SIGKILL);
    wait();
  }
}

void Process::send(int signal) const { ::kill(pid_, signal); }

bool Process::running() {
  if (pid_ > 0 && ::waitpid(pid_, &status_, WNOHANG) == pid_) pid_ = 0;
  return pid_ > 0;
}

int Process::wait() {
  if (pid_ > 0) ::waitpid(pid_, &status_, 0);
  pid_ = 0;
  return WIFEXITED(status_) ? WEXITSTATUS(status_) : -WTERMSIG(status_);
}

std::string Process::log() const { return bytes_of(log_); }

}  // namespace clearway::test
