#pragma once

#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>

#include "tools/cli/program.hpp"

namespace clearway::test {

/// A process of the built program, its output in a file.
class Process {
 public:
  Process(const std::string& arguments, std::filesystem::path log) : log_(std::move(log)) {
    std::string command = std::string("exec '") + CLEARWAY_PROGRAM + "' " + arguments + " >'" +
                          log_.string() + "' 2>&1";
    char sh[] = "/bin/sh", c[] = "-c";
    char* words[] = {sh, c, command.data(), nullptr};
    if (::posix_spawn(&pid_, sh, nullptr, nullptr, words, environ) != 0) {
      throw std::runtime_error("cannot start the program");
    }
  }
  ~Process() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      wait();
    }
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void send(int signal) const { ::kill(pid_, signal); }
  bool running() {
    if (pid_ > 0 && ::waitpid(pid_, &status_, WNOHANG) == pid_) pid_ = 0;
    return pid_ > 0;
  }
  /// Exit code, or minus the signal that killed it.
  int wait() {
    if (pid_ > 0) ::waitpid(pid_, &status_, 0);
    pid_ = 0;
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : -WTERMSIG(status_);
  }
  std::string log() const { return bytes_of(log_); }

 private:
  std::filesystem::path log_;
  pid_t pid_ = 0;
  int status_ = 0;
};

}  // namespace clearway::test
