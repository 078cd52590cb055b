#pragma once

#include <cstdint>
#include <filesystem>

#include "cli/conflicts/conflict_inputs.hpp"

namespace clearway::tool {

/// The results and trajectories of `clearway compare --conflicts`.
struct ConflictComparison : ConflictCommand {
  std::filesystem::path trajectory, trajectory_b, vehicle, vehicle_b, output;
  ModelOptions model_options;
  double worse_by = 0.02;  ///< metres
  bool allow_other_question = false, force = false;
};

/// --trajectory, --trajectory-b and what else only this comparison takes; all need `conflicts`.
void add_conflict_comparison(CLI::App& command, ConflictComparison& options,
                             CLI::Option* conflicts);

/// Says which conflicts are new, worse, gone and the same, and how the questions differ; prints at
/// most `show` of each list. False where b has new or worse ones, new groups that are too small to
/// be listed, or answers another question and that was not allowed.
bool compare_conflicts(ConflictComparison& options, const std::filesystem::path& a,
                       const std::filesystem::path& b, std::uint64_t show, bool json);

}  // namespace clearway::tool
