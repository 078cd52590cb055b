#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "campaign/task_state.hpp"
#include "io/files/json.hpp"

/// What is known of runs, as the page, `campaign status` and `campaign run` say it.
namespace clearway::campaign {

/// Each run has exactly one of these.
enum class Outcome {
  kConflict,
  kUndecided,  ///< a collision is neither certain nor excluded, or the question is in doubt
  kClearWithWarnings,
  kClear,
  kFailed,
  kUnfinished
};

struct OutcomeWords {
  Outcome outcome;
  /// The name in JSON, and as a class of the style sheet, for example "not_done".
  const char* name;
  /// A character that shows the outcome without colour.
  const char* sign;
  /// The word after a count, for example "clear with warnings".
  const char* word;
  /// What one run does that has the outcome, and what several do.
  const char *one, *several;
  /// The text of the legend, which says what the outcome means.
  const char* meaning;
};

inline constexpr std::array<OutcomeWords, 6> kOutcomes{
    {{Outcome::kConflict, "conflict", "■", "conflict", "finds a conflict", "find a conflict",
      "conflict: a point is closer than the radius, or with an error budget certainly too close"},
     {Outcome::kUndecided, "undecided", "?", "undecided", "is undecided", "are undecided",
      "undecided: a collision is neither certain nor excluded, or the question is in doubt; "
      "reasons and warnings say why"},
     {Outcome::kClearWithWarnings, "clear_with_warnings", "△", "clear with warnings",
      "is clear with warnings", "are clear with warnings",
      "clear with warnings: nothing is closer than the radius, but read the warnings below"},
     {Outcome::kClear, "clear", "○", "clear", "is clear", "are clear",
      "clear: no point is closer than the radius and the errors, and where seen space was asked "
      "for, all of it was scanned"},
     {Outcome::kFailed, "failed", "✕", "failed", "has failed", "have failed",
      "failed: nothing is known"},
     {Outcome::kUnfinished, "not_done", "…", "not done", "is not done", "are not done",
      "not done yet, or a file has changed since: nothing is known"}}};

inline const OutcomeWords& words_of(Outcome outcome) {
  return kOutcomes.at(static_cast<std::size_t>(outcome));
}

Outcome outcome_of(const TaskStatus& run);
/// The outcome without the conflicts that the ledger of the run accepts.
Outcome outcome_outside(const TaskStatus& run);

/// For example "5 runs: 1 conflict, 1 undecided, 1 clear with warnings, 1 clear, 1 failed, 0 not
/// done".
std::string counts_text(const std::vector<TaskStatus>& runs);
/// An object with the counts under the names of the outcomes, which add up to the number of runs.
Json counts_json(const std::vector<TaskStatus>& runs);

/// The sums of rows and conflicts by status over the ledgers of all runs; null where no run has
/// one.
Json ledgers_of(const std::vector<TaskStatus>& runs);
/// The statuses of ledgers with their numbers, such as "2 accepted, 1 gone"; empty where nothing is
/// in them, and without a ledger. ledger: the member of the facts, or a sum of several.
std::string ledger_words(const Json& ledger);

/// What has to be said of a run that is done besides the verdict, for example "2 warnings
/// (out-of-reach, scan-ends); 1,234 points ignored, of which 56 would collide". Empty where there
/// is nothing to say. unit: of its lengths, for example "m".
std::string caveats_of(const Json& facts, const std::string& unit);

/// What `campaign report` says of a campaign, as one JSON object. runs: those of runs_of().
Json report_facts(const Plan& plan, const std::vector<TaskStatus>& runs, const std::string& date);
/// The sentences and words in which the page says it, beside these facts.
Json report_words(const std::vector<TaskStatus>& runs);

}  // namespace clearway::campaign
