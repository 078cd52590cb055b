#pragma once

#include <filesystem>

#include "cli/conflicts/conflict_inputs.hpp"

namespace clearway::tool {

/// The results and trajectories of `clearway compare --conflicts`.
struct ConflictComparison : ConflictCommand {
  std::filesystem::path trajectory, trajectory_b;
};

/// --trajectory, --trajectory-b and what add_conflict_options adds; all need `conflicts`.
void add_conflict_comparison(CLI::App& command, ConflictComparison& options,
                             CLI::Option* conflicts);

/// Prints which conflicts are new, gone and the same; at most `show` of each list. False where
/// there are new ones.
bool compare_conflicts(ConflictComparison& options, const std::filesystem::path& a,
                       const std::filesystem::path& b, std::size_t show, bool json);

}  // namespace clearway::tool
