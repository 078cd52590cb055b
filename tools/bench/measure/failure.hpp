#pragma once

#include "bench/measure/program.hpp"
#include "bench/measure/record.hpp"

namespace clearway::bench {

/// A refusal that says something of the method, so that a case may end with it.
enum class Refusal {
  kNone,
  kMemory,        ///< more than --memory or --device-memory is needed
  kNonRigidPoses  ///< without --allow-non-rigid
};

/// Whether a run that failed was stopped by the limit or ended with this refusal. All else, such as
/// a full disk, says nothing of the method.
bool is_finding(const ProgramRun& failed, Refusal expected);

/// What is kept of it. limit_seconds: that of the run.
Json failure_of(const ProgramRun& failed, double limit_seconds);

/// In a line, from what is kept.
std::string reason_of(const Json& failure);

}  // namespace clearway::bench
