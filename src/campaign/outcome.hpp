#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "campaign/plan.hpp"
#include "campaign/task_state.hpp"

namespace clearway::campaign {

/// What is known of a run, as the page, `campaign status` and `campaign run` count it. Each run has
/// exactly one of these.
enum class Outcome {
  kConflict,
  kUndecided,  ///< the search could not have found anything
  kDoubtful,   ///< clear, but there were warnings
  kClear,
  kFailed,
  kUnfinished
};
inline constexpr std::array kOutcomes{Outcome::kConflict, Outcome::kUndecided,
                                      Outcome::kDoubtful, Outcome::kClear,
                                      Outcome::kFailed,   Outcome::kUnfinished};

struct OutcomeWords {
  /// The name in JSON, and as a class of the style sheet, for example "doubtful".
  const char* name;
  /// A character that tells the outcome without colour.
  const char* sign;
  /// The word after a count, for example "clear with warnings".
  const char* word;
  /// The text of the legend, which says what the outcome means.
  const char* words;
};
const OutcomeWords& words_of(Outcome outcome);

Outcome outcome_of(const TaskLook& look);

/// The tasks of a plan that are runs, not shards, with their state. A run one of whose shards has
/// failed has failed itself.
struct RunLooks {
  Plan plan;
  std::vector<TaskLook> looks;
};
RunLooks run_looks(const Plan& plan, const std::vector<TaskLook>& looks);

/// How many runs have each outcome, in the order of kOutcomes. The counts add up to the number of
/// runs.
class OutcomeCounts {
 public:
  /// looks: those of run_looks().
  explicit OutcomeCounts(const std::vector<TaskLook>& looks);

  std::size_t of(Outcome outcome) const { return counts_.at(static_cast<std::size_t>(outcome)); }
  std::size_t all() const;
  /// For example "5 runs: 1 conflict, 1 undecided, 1 clear with warnings, 1 clear, 1 failed, 0 not
  /// done".
  std::string text() const;
  /// An object with the counts under the names of the outcomes.
  nlohmann::ordered_json json() const;

 private:
  std::array<std::size_t, kOutcomes.size()> counts_{};
};

/// What has to be said beside the verdict of a run that is done, for example "2 warnings
/// (out-of-reach, scan-ends); 1,234 points ignored, of which 56 would collide; not exact". Empty
/// where there is nothing to say.
std::string caveats_of(const nlohmann::ordered_json& facts);

/// Whether the run was asked for an exact answer, that is, without a tolerance and in double
/// precision.
bool is_exact(const nlohmann::ordered_json& facts);

/// For example "1,234 points ignored, of which 56 would collide"; empty where none is ignored.
std::string ignored_words(const nlohmann::ordered_json& facts);

}  // namespace clearway::campaign
