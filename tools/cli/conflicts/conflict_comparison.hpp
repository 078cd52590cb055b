#pragma once

#include <vector>

#include "cli/conflicts/conflict_inputs.hpp"
#include "io/files/json.hpp"
#include "io/result/check_results.hpp"

namespace clearway::tool {

/// The options of `clearway compare`, with the files of a.
struct ConflictComparison : ConflictCommand {
  bool conflicts = false;  ///< whether conflicts are compared, and not points
  SearchedFiles b;         ///< what is not given is that of a
  double worse_by = 0.02;  ///< metres by which a conflict must come nearer, or deeper, to be worse
  bool allow_other_question = false;
};

/// Adds --trajectory, --trajectory-b and the other options that only this comparison takes; all
/// need `conflicts`.
void add_conflict_comparison(CLI::App& command, ConflictComparison& options,
                             CLI::Option* conflicts);

/// Prints which conflicts are new, worse, gone and the same, and how the questions differ. Returns
/// the exit code: 1 where b is worse or answers another question, 6 where b cannot show that
/// nothing became worse, and otherwise 0.
int compare_conflicts(ConflictComparison& options);

/// How the questions of two results differ, as both kinds of comparison print it.
Json questions_json(const std::vector<QueryDifference>& questions);

}  // namespace clearway::tool
