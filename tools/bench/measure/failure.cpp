#include "bench/measure/failure.hpp"

#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>

#include "cli/support/program.hpp"
#include "core/messages/remedies.hpp"

namespace clearway::bench {

namespace {

/// Whether a log has the words of a remedy, with an amount or without.
bool says(const std::string& log, Remedy remedy) {
  return log.find(kind_of(remedy).words) != std::string::npos || amount_in(log, remedy);
}

}  // namespace

bool is_finding(const ProgramRun& failed, Refusal expected) {
  if (failed.timed_out) return true;
  switch (expected) {
    case Refusal::kNone:
      return false;
    case Refusal::kMemory:
      return failed.exit_code == kResource &&
             (says(failed.log, Remedy::kMoreMemory) || says(failed.log, Remedy::kMoreDeviceMemory));
    case Refusal::kNonRigidPoses:
      return failed.exit_code == kBadInput && says(failed.log, Remedy::kAllowNonRigid);
  }
  return false;
}

std::optional<std::uint64_t> amount_in(const std::string& log, Remedy remedy) {
  const std::string_view words = kind_of(remedy).words_with_amount;
  const std::size_t place = words.find("{}");
  if (place == std::string_view::npos) return {};
  const std::size_t before = log.find(words.substr(0, place));
  if (before == std::string::npos) return {};
  const char* const end = log.data() + log.size();
  std::uint64_t amount = 0;
  const auto [after, error] = std::from_chars(log.data() + before + place, end, amount);
  const bool is_said =
      error == std::errc() && std::string_view(after, end).starts_with(words.substr(place + 2));
  return is_said ? std::optional(amount) : std::nullopt;
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
