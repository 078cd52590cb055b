#pragma once

namespace CLI {
class App;
}

/// The functions below add the subcommands of `clearway trajectory`.
namespace clearway::tool {

void add_trajectory_alignment(CLI::App& trajectory);
/// Adds resample and thin.
void add_trajectory_changes(CLI::App& trajectory);
void add_trajectory_follow(CLI::App& trajectory);
void add_trajectory_info(CLI::App& trajectory);

}  // namespace clearway::tool
