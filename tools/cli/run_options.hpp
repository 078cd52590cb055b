#pragma once

#include <filesystem>

#include "io/trajectory/trajectory.hpp"
#include "search/engines.hpp"

namespace CLI {
class App;
}

namespace clearway::tool {

/// The command line of `clearway run`.
struct RunOptions {
  std::filesystem::path environment, model, trajectory, output;
  QueryParameters query;
  EngineOptions engine;
  TrajectoryOptions trajectory_options;
  bool force = false;
  bool resume = false;
  double journal_interval_seconds = 5;
  bool json = false;
};

/// `options` outlive the command.
void add_run_options(CLI::App& command, RunOptions& options);

}  // namespace clearway::tool
