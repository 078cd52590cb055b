#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "clearway/model.hpp"
#include "clearway/search.hpp"
#include "clearway/trajectory.hpp"
#include "cli/support/lengths.hpp"

namespace CLI {
class App;
}

namespace clearway::tool {

/// The options of `clearway run`.
struct RunOptions {
  std::filesystem::path environment, model, vehicle, trajectory, output;
  QueryParameters query;
  SearchOptions search;
  ModelOptions model_options;
  TrajectoryOptions trajectory_options;
  LengthOptions lengths;
  bool fail_on_collision = false;
  bool json = false;
  bool names_nearest = true;  ///< whether the sentence of a conflict names the nearest place
};

/// The options by which the model of a run is read. Throws UsageError for options that contradict
/// each other.
ModelOptions model_options_of(const RunOptions& options);

/// Adds the options of `clearway run`. `options` outlive the command.
void add_run_options(CLI::App& command, RunOptions& options);

}  // namespace clearway::tool
