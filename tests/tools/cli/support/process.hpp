#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>

namespace clearway::test {

/// A process of the built program that writes its output to a file.
class Process {
 public:
  Process(const std::string& arguments, std::filesystem::path log);
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  ~Process();

  void send(int signal) const;
  bool running();
  /// Waits for the end; the exit code, or minus the signal that killed the process.
  int wait();
  std::string log() const;

 private:
  std::filesystem::path log_;
  pid_t pid_ = 0;
  int status_ = 0;
};

}  // namespace clearway::test
