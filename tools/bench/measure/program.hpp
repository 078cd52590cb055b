#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace clearway::bench {

/// What one run of the measured program did.
struct ProgramRun {
  int exit_code = 0;
  bool timed_out = false;
  std::string output, log;       ///< standard output and standard error
  double wall_seconds = 0;       ///< from the start of the process to its end
  double cpu_seconds = 0;        ///< of all threads, time in the system included
  std::uint64_t peak_bytes = 0;  ///< peak of resident memory, mapped files included
};

/// The program `clearway` that is measured.
class Program {
 public:
  /// An empty path stands for the program beside this one. Throws UsageError where there is none.
  explicit Program(std::filesystem::path path);

  const std::filesystem::path& path() const { return path_; }

  /// Runs the program in a process of its own with these arguments. The process is asked to stop
  /// after `limit_seconds` (0: never). Throws ResourceError where it cannot be started or a signal
  /// ends it, Interrupted where this program or the process was interrupted.
  ProgramRun run(std::vector<std::string> arguments, double limit_seconds = 0) const;

  /// The standard output of a run with these arguments. Throws ResourceError with command and log
  /// unless it exits with 0.
  std::string output_of(const std::vector<std::string>& arguments) const;

 private:
  std::filesystem::path path_;
};

}  // namespace clearway::bench
