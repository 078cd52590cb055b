#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "bench/measure/program.hpp"
#include "bench/measure/record.hpp"
#include "clearway/error.hpp"

namespace clearway::bench {

/// A refusal that says something about the method, so that a case may end with it.
enum class Refusal {
  kNone,
  kMemory,        ///< more than --memory or --device-memory is needed
  kNonRigidPoses  ///< without --allow-non-rigid
};

/// Whether a failed run was stopped by the limit or ended with this refusal. Any other failure,
/// such as a full disk, says nothing about the method.
bool is_finding(const ProgramRun& failed, Refusal expected);

/// The amount that a log says with the words of a remedy; nothing where it does not say them with
/// one.
std::optional<std::uint64_t> amount_in(const std::string& log, Remedy remedy);

/// What is recorded of a failed run. limit_seconds: the limit of the run.
Json failure_of(const ProgramRun& failed, double limit_seconds);

/// The reason of a recorded failure, in one line.
std::string reason_of(const Json& failure);

}  // namespace clearway::bench
