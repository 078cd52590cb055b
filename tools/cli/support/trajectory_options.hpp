#pragma once

#include "clearway/trajectory.hpp"

namespace CLI {
class App;
}

namespace clearway::tool {

class LengthOptions;

inline constexpr const char* kTrajectoryHelp =
    "The poses: 12 or 16 numbers a line, TUM, EuRoC, CSV with a header, SBET, or 3DTK";

/// Adds the options of every command that reads a trajectory: --trajectory-format, --angles and so
/// on.
void add_trajectory_options(CLI::App& command, TrajectoryOptions& options, LengthOptions& lengths);

/// Adds those of these options that say how a trajectory is read, for a command whose trajectory is
/// not that of the model.
void add_options_of_reading(CLI::App& command, TrajectoryOptions& options, LengthOptions& lengths);

}  // namespace clearway::tool
