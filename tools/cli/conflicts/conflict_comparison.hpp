#pragma once

#include <cstdint>
#include <filesystem>

#include "cli/conflicts/conflict_inputs.hpp"

namespace clearway::tool {

/// The options of `clearway compare --conflicts`.
struct ConflictComparison : ConflictCommand {
  std::filesystem::path trajectory, trajectory_b, vehicle, vehicle_b, output;
  ModelOptions model_options;
  double worse_by = 0.02;  ///< metres by which a conflict must come nearer, or deeper, to be worse
  bool allow_other_question = false, force = false;
};

/// Adds --trajectory, --trajectory-b and the other options that only this comparison takes; all
/// need `conflicts`.
void add_conflict_comparison(CLI::App& command, ConflictComparison& options,
                             CLI::Option* conflicts);

/// Prints which conflicts are new, worse, gone and the same, at most `show` of each list, and how
/// the questions differ. False where b has new or worse conflicts, or new groups that are too small
/// to be listed, or answers another question and that was not allowed.
bool compare_conflicts(ConflictComparison& options, const std::filesystem::path& a,
                       const std::filesystem::path& b, std::uint64_t show, bool json);

}  // namespace clearway::tool
