#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace clearway::tool {

/// What a process of this program did.
struct ProgramRun {
  int exit_code = 0;
  bool timed_out = false;
  std::string output, log;       ///< standard output and standard error
  double wall_seconds = 0;       ///< from its start to its end
  std::uint64_t peak_bytes = 0;  ///< of resident memory, mapped files included
};

/// Runs this program in a process of its own with these arguments, `clearway` itself left out; it
/// is asked to stop where it takes longer than that (0: as long as it likes). Throws ResourceError
/// where it cannot be started or dies of a signal, Interrupted where it was.
ProgramRun run_program(std::vector<std::string> arguments, double limit_seconds = 0);

/// Its standard output; throws ResourceError with its command and log unless it exits with 0.
std::string output_of_program(const std::vector<std::string>& arguments);

}  // namespace clearway::tool
