#include "bench/measure/failure.hpp"

#include <cmath>
#include <regex>

#include "cli/support/program.hpp"

namespace clearway::bench {

bool is_finding(const ProgramRun& failed, Refusal expected) {
  if (failed.timed_out) return true;
  switch (expected) {
    case Refusal::kNone:
      return false;
    case Refusal::kMemory: {
      static const std::regex kTooLittle("--(device-)?memory( [0-9.]+ [KMGT]?i?B)? is too little");
      return failed.exit_code == kResource && std::regex_search(failed.log, kTooLittle);
    }
    case Refusal::kNonRigidPoses:
      return failed.exit_code == kBadInput &&
             failed.log.find("(--allow-non-rigid accepts") != std::string::npos;
  }
  return false;
}

Json failure_of(const ProgramRun& failed, double limit_seconds) {
  if (failed.timed_out) return {{"after_seconds", failed.wall_seconds}, {"limit", limit_seconds}};
  return {{"exit_code", failed.exit_code}, {"log", failed.log}};
}

std::string reason_of(const Json& failure) {
  if (failure.contains("after_seconds")) {
    const auto seconds = std::llround(failure["after_seconds"].get<double>());
    return "stopped after " + std::to_string(seconds) + " s";
  }
  std::string log = failure["log"];
  log.erase(log.find_last_not_of('\n') + 1);
  return log.substr(log.rfind('\n') + 1) + " (exit code " + failure["exit_code"].dump() + ")";
}

}  // namespace clearway::bench
