#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "campaign/plan.hpp"
#include "campaign/task_state.hpp"

namespace clearway::campaign {

/// What is known of a run, as page, status and `campaign run` count it: each run has one of these.
enum class Outcome {
  kConflict,
  kUndecided,  ///< the search could not have found anything
  kDoubtful,   ///< clear, but something was warned of
  kClear,
  kFailed,
  kUnfinished
};
inline constexpr std::array kOutcomes{Outcome::kConflict, Outcome::kUndecided,
                                      Outcome::kDoubtful, Outcome::kClear,
                                      Outcome::kFailed,   Outcome::kUnfinished};

struct OutcomeWords {
  const char* name;   ///< in JSON, and as a class of styles: "doubtful"
  const char* sign;   ///< tells it without colour
  const char* word;   ///< for a count: "clear with warnings"
  const char* words;  ///< for the legend, with what it means
};
const OutcomeWords& words_of(Outcome outcome);

Outcome outcome_of(const TaskLook& look);

/// The tasks of a plan that are runs, not shards, and how they look: a run one of whose shards
/// failed has failed.
struct RunLooks {
  Plan plan;
  std::vector<TaskLook> looks;
};
RunLooks run_looks(const Plan& plan, const std::vector<TaskLook>& looks);

/// How many runs have each outcome, in the order of kOutcomes: together all of them.
class OutcomeCounts {
 public:
  /// looks: those of run_looks().
  explicit OutcomeCounts(const std::vector<TaskLook>& looks);

  std::size_t of(Outcome outcome) const { return counts_.at(static_cast<std::size_t>(outcome)); }
  std::size_t all() const;
  /// "5 runs: 1 conflict, 1 undecided, 1 clear with warnings, 1 clear, 1 failed, 0 not done"
  std::string text() const;
  /// The counts by the names of outcomes.
  nlohmann::ordered_json json() const;

 private:
  std::array<std::size_t, kOutcomes.size()> counts_{};
};

/// What has to be said beside the verdict of a run that is done: "2 warnings (out-of-reach,
/// scan-ends); 1,234 points ignored, of which 56 would collide; not exact". Empty where there is
/// nothing.
std::string caveats_of(const nlohmann::ordered_json& facts);

/// Whether the run was asked for an exact answer: without a tolerance, and in double precision.
bool is_exact(const nlohmann::ordered_json& facts);

/// "1,234 points ignored, of which 56 would collide"; empty where none is.
std::string ignored_words(const nlohmann::ordered_json& facts);

}  // namespace clearway::campaign
