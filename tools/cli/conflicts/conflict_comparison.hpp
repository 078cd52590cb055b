#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/conflicts.hpp"
#include "cli/conflicts/conflict_inputs.hpp"
#include "cli/support/program.hpp"
#include "findings/match_conflicts.hpp"
#include "io/result/check_results.hpp"
#include "io/scans/scan_dates.hpp"

namespace clearway::tool {

/// The options of `clearway compare --conflicts`, with the files of a.
struct ConflictComparison : ConflictCommand {
  SearchedFiles b;         ///< what is not given is that of a
  double worse_by = 0.02;  ///< metres by which a conflict must come nearer, or deeper, to be worse
  bool allow_other_question = false;
};

/// Adds --trajectory, --trajectory-b and the other options that only this comparison takes; all
/// need `conflicts`.
void add_conflict_comparison(CLI::App& command, ConflictComparison& options,
                             CLI::Option* conflicts);

/// Prints which conflicts are new, worse, gone and the same, and how the questions differ. Returns
/// ComparedConflicts::exit_code().
int compare_conflicts(ConflictComparison& options);

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
  std::string words;                 ///< verdict_words() of the answer
  std::vector<std::string> doubts;   ///< see Answer
  std::vector<std::string> reasons;  ///< names of the reasons of an undecided verdict
  std::vector<double> chainage;      ///< of each pose, metres, from --chainage-start on
  std::vector<Vec3> path;            ///< the position of each pose
  ScanDates scanned;                 ///< the days of the scans, by the dates of their files
  bool has_distances = false;        ///< whether the run had clearances
  bool has_surface = false;          ///< whether the model has triangles
  bool has_solids = false;           ///< whether the depth inside the model is known
  bool has_shifts = false;           ///< whether the model was given, so that shifts are known

  /// Whether something could not be found, whatever the verdict is about the rest.
  bool undecided() const { return verdict == Verdict::kUndecided || !doubts.empty(); }
};

/// The outcome of a comparison of two results' conflicts.
struct ComparedConflicts {
  ComparedResult a, b;
  std::vector<QueryDifference> questions;
  bool other_question_allowed = false;
  bool distances_known = false;  ///< whether both results have distances
  double worse_by = 0;
  ConflictMatch match;       ///< which conflicts are new, gone and the same, worse or not
  bool same_points = false;  ///< whether both results are about the same points
  /// Whether b is older than a by the dates of the files, which may have been exported anew since
  /// the scans; nothing where these show no order
  std::optional<bool> is_older = {};
  /// Ids of the same conflict in a and b where b's is worse.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> worse;
  /// Ids of the same conflict in a and b of which it is unknown whether b's is worse, because the
  /// depth of a point behind a surface is not known, and no model was given to find shifts with.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> unknown_worse;

  /// Number of conflicts of b that are in match.same.
  std::size_t same_in_b() const;
  /// Whether both results answer the same question about the same points, as where one scan was
  /// given twice.
  bool is_same_scan() const { return questions.empty() && same_points; }
  bool same_question() const { return questions.empty() || other_question_allowed; }
  /// Whether b is seen to be worse than a, or answers another question that was not allowed.
  bool differs() const {
    return !same_question() || !match.added.empty() || !match.grown.empty() || !worse.empty() ||
           !match.small.empty();
  }
  /// Whether b cannot show that nothing became worse: something could not be found in it, it has
  /// not searched a place where a has a conflict, or it is the same scan as a or an older one.
  bool shows_nothing() const {
    return b.undecided() || !match.not_searched.empty() || is_same_scan() ||
           is_older.value_or(false);
  }
  /// Whether b is no worse than a, and answers the same question or an allowed one.
  bool holds() const { return !differs() && !shows_nothing(); }
  /// 1 where they differ, 6 where b shows nothing, and otherwise 0.
  int exit_code() const { return differs() ? kDiffers : shows_nothing() ? kUndecided : kDone; }
};

/// Why a conflict is worse, such as "0.080 -> 0.030 m", or "freed by a shift of 0.100 -> 0.250 m".
std::string worsening_text(const ComparedConflicts& found, const Conflict& a, const Conflict& b);

/// The comparison as a page for any browser. output: the page's file, from which its links lead.
std::string html_of(const ComparedConflicts& found, const std::filesystem::path& output);

/// What the comparison found, in one sentence: the last line of the text.
std::string sentence_of(const ComparedConflicts& found);

/// The comparison as one JSON object, with a line break at its end.
std::string json_of(const ComparedConflicts& found);

enum class ComparisonFormat { kCsv, kJson, kHtml };

/// The form that the ending of a file's name means. Throws UsageError for another ending.
ComparisonFormat comparison_format_of(const std::filesystem::path& output);

/// Writes the comparison to `path`, from which it gets to `output`.
void write_comparison(const ComparedConflicts& found, ComparisonFormat format,
                      const std::filesystem::path& output, const std::filesystem::path& path);

}  // namespace clearway::tool
