#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>

#include "clearway/engines.hpp"
#include "io/trajectory.hpp"

namespace clearway::tool {

/// The command line of `clearway run`.
struct RunOptions {
  std::filesystem::path environment, model, trajectory, output;
  double radius = 0;
  EngineOptions engine;
  bool first_pose = false;
  double clearance = 0;
  bool between_poses = false;
  double tolerance = 0;
  TrajectoryOptions trajectory_options;
  bool force = false;
  bool resume = false;
  double journal_interval_seconds = 5;
  bool json = false;
};

/// `options` outlive the command.
void add_run_options(CLI::App& command, RunOptions& options);

}  // namespace clearway::tool
