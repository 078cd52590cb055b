#include <CLI/CLI.hpp>

#include "cli/commands.hpp"
#include "cli/trajectory/commands.hpp"

namespace clearway::tool {

void add_trajectory(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("trajectory",
                             "Say what is in a trajectory, make it denser or "
                             "sparser, follow it, make one of an alignment or a line");
  command->require_subcommand(1);
  add_trajectory_info(*command);
  add_trajectory_changes(*command);
  add_trajectory_follow(*command);
  add_trajectory_alignment(*command);
  add_trajectory_line(*command);
}

}  // namespace clearway::tool
