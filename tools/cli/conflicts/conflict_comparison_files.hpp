#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "clearway/conflicts.hpp"
#include "findings/match_conflicts.hpp"
#include "io/result/check/compare_results.hpp"

namespace clearway::tool {

/// The listed conflict of this id.
inline const Conflict& conflict_at(const Conflicts& conflicts, std::uint32_t id) {
  return conflicts.listed[id - 1];
}

/// A result and its conflicts.
struct ComparedResult {
  std::string file;
  double radius = 0;
  std::string unit;
  Conflicts conflicts;
};

/// What comparing the conflicts of two results found.
struct ComparedConflicts {
  ComparedResult a, b;
  std::vector<QueryDifference> questions;
  bool other_question_allowed = false;
  bool distances_known = false;  ///< of both: otherwise nothing can be called worse
  double worse_by = 0;
  ConflictMatch match;                                         ///< the same ones, worse or not
  std::vector<std::pair<std::uint32_t, std::uint32_t>> worse;  ///< of the same ones
  std::vector<std::size_t> new_small;  ///< of b.conflicts.small, those that a has nothing near

  bool same_question() const { return questions.empty() || other_question_allowed; }
  /// Whether b is no worse than a.
  bool holds() const {
    return same_question() && match.added.empty() && worse.empty() && new_small.empty();
  }
};

/// The last line of the text: what was found, in a sentence.
std::string sentence_of(const ComparedConflicts& found);

/// One JSON object, with a line break at its end.
std::string json_of(const ComparedConflicts& found);

/// The endings of the files that a comparison is written to: .csv, .json, .html. Throws UsageError
/// for another one.
void check_comparison_ending(const std::filesystem::path& output);

/// Writes the form that the ending of `output` names to `path`.
void write_comparison(const ComparedConflicts& found, const std::filesystem::path& output,
                      const std::filesystem::path& path);

}  // namespace clearway::tool
