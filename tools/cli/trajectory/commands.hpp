#pragma once

#include <optional>
#include <string>

#include "clearway/alignment.hpp"

namespace CLI {
class App;
}

/// The functions below add the subcommands of `clearway trajectory`.
namespace clearway::tool {

void add_trajectory_alignment(CLI::App& trajectory);
/// Adds resample, thin and smooth.
void add_trajectory_changes(CLI::App& trajectory);
void add_trajectory_follow(CLI::App& trajectory);
void add_trajectory_info(CLI::App& trajectory);
void add_trajectory_line(CLI::App& trajectory);

/// Adds --cant, which takes the names of CantLine, without one that makes no sense for the command.
void add_cant_option(CLI::App& command, CantLine& cant, const std::string& description,
                     std::optional<CantLine> without = {});

}  // namespace clearway::tool
