#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/conflicts.hpp"
#include "cli/conflicts/conflict_inputs.hpp"
#include "cli/support/program.hpp"
#include "findings/match_conflicts.hpp"
#include "io/result/check_results.hpp"

namespace clearway::tool {

/// The options of `clearway compare --conflicts`.
struct ConflictComparison : ConflictCommand {
  std::filesystem::path trajectory, trajectory_b, model, model_b, vehicle, vehicle_b;
  std::vector<std::filesystem::path> outputs;
  ModelOptions model_options;
  double worse_by = 0.02;  ///< metres by which a conflict must come nearer, or deeper, to be worse
  bool allow_other_question = false, force = false;
};

/// Adds --trajectory, --trajectory-b and the other options that only this comparison takes; all
/// need `conflicts`.
void add_conflict_comparison(CLI::App& command, ConflictComparison& options,
                             CLI::Option* conflicts);

/// Prints which conflicts are new, worse, gone and the same, at most `show` of each list, and how
/// the questions differ. Returns ComparedConflicts::exit_code().
int compare_conflicts(ConflictComparison& options, const std::filesystem::path& a,
                      const std::filesystem::path& b, std::uint64_t show, bool json);

/// The listed conflict with this id; ids count from 1.
inline const Conflict& conflict_at(const Conflicts& conflicts, std::uint32_t id) {
  return conflicts.listed[id - 1];
}

/// A result and its conflicts.
struct ComparedResult {
  std::string file;
  double radius = 0;
  std::string unit;
  Conflicts conflicts;
  Verdict verdict = Verdict::kUnknown;
  std::vector<std::string> doubts;  ///< why the verdict is undecided; see Answer
  bool has_distances = false;       ///< whether the run had clearances
  bool has_surface = false;         ///< whether the model has triangles
  bool has_solids = false;          ///< whether the depth inside the model is known
  bool has_shifts = false;          ///< whether the model was given, so that shifts are known

  bool undecided() const { return verdict == Verdict::kUndecided; }
};

/// The outcome of a comparison of two results' conflicts.
struct ComparedConflicts {
  ComparedResult a, b;
  std::vector<QueryDifference> questions;
  bool other_question_allowed = false;
  bool distances_known = false;  ///< whether both results have distances
  double worse_by = 0;
  ConflictMatch match;  ///< which conflicts are new, gone and the same, worse or not
  /// Ids of the same conflict in a and b where b's is worse.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> worse;
  /// Ids of the same conflict in a and b of which it is unknown whether b's is worse, because the
  /// depth of a point behind a surface is not known, and no model was given to find shifts with.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> unknown_worse;
  /// Indices into b.conflicts.small of the groups that a has nothing near.
  std::vector<std::size_t> new_small;

  bool same_question() const { return questions.empty() || other_question_allowed; }
  /// Whether b is seen to be worse than a, or answers another question that was not allowed.
  bool differs() const {
    return !same_question() || !match.added.empty() || !worse.empty() || !new_small.empty();
  }
  /// Whether b is no worse than a, and answers the same question or an allowed one. A b that is
  /// undecided shows nothing.
  bool holds() const { return !differs() && !b.undecided(); }
  /// 1 where they differ, 6 where b is undecided, and otherwise 0.
  int exit_code() const { return differs() ? kDiffers : b.undecided() ? kUndecided : kDone; }
};

/// What the comparison found, in one sentence: the last line of the text.
std::string sentence_of(const ComparedConflicts& found);

/// The comparison as one JSON object, with a line break at its end.
std::string json_of(const ComparedConflicts& found);

/// Throws UsageError unless `output` ends in .csv, .json or .html, the forms in which a comparison
/// is written.
void check_comparison_ending(const std::filesystem::path& output);

/// Writes the comparison to `path`, in the form that the ending of `output` names.
void write_comparison(const ComparedConflicts& found, const std::filesystem::path& output,
                      const std::filesystem::path& path);

}  // namespace clearway::tool
