#pragma once

#include "clearway/trajectory.hpp"

namespace CLI {
class App;
}

namespace clearway::tool {

/// What every command that reads a trajectory takes: --trajectory-format, --angles and so on.
void add_trajectory_options(CLI::App& command, TrajectoryOptions& options);

}  // namespace clearway::tool
