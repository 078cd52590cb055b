#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace clearway::bench {

/// What a process of the measured program did.
struct ProgramRun {
  int exit_code = 0;
  bool timed_out = false;
  std::string output, log;       ///< standard output and standard error
  double wall_seconds = 0;       ///< from its start to its end
  double cpu_seconds = 0;        ///< of all its threads, the system's included
  std::uint64_t peak_bytes = 0;  ///< of resident memory, mapped files included
};

/// The program `clearway` that is measured.
class Program {
 public:
  /// An empty path stands for the one beside this program. Throws UsageError where there is none.
  explicit Program(std::filesystem::path path);

  const std::filesystem::path& path() const { return path_; }

  /// Runs it in a process of its own with these arguments. The process is asked to stop after
  /// `limit_seconds` (0: never). Throws ResourceError where it cannot be started or a signal ends
  /// it, Interrupted where this program or it was interrupted.
  ProgramRun run(std::vector<std::string> arguments, double limit_seconds = 0) const;

  /// Its standard output; throws ResourceError with command and log unless it exits with 0.
  std::string output_of(const std::vector<std::string>& arguments) const;

 private:
  std::filesystem::path path_;
};

}  // namespace clearway::bench
