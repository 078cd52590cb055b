#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "clearway/model.hpp"
#include "clearway/search.hpp"
#include "clearway/trajectory.hpp"
#include "cli/support/lengths.hpp"

namespace CLI {
class App;
}

namespace clearway::tool {

/// The frame and unit of an environment, in which paths and models are read.
struct EnvironmentFrame {
  std::string crs;  ///< empty where it is not known
  double metres_per_unit = 1;
  bool unit_is_assumed = false;
};

/// What was read of a question for an environment: model or vehicle, and path.
struct RunInputs {
  EnvironmentFrame frame;
  std::filesystem::path trajectory;
  Query query;  ///< without its parameters
  PoseLabels labels;
  std::vector<Message> warnings;
  bool name_units = false;  ///< whether the files of the model and of the path name their units
};

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
  /// Inputs that were read already with the same options, or null. They are taken, and not read
  /// again, if their frame is that of the environment.
  std::shared_ptr<RunInputs> inputs;
};

/// The options by which the model of a run is read. Throws UsageError for options that contradict
/// each other.
ModelOptions model_options_of(const RunOptions& options);

/// Reads model or vehicle, and trajectory. Sets the frame in the options of their readers.
RunInputs read_inputs(RunOptions& options, const EnvironmentFrame& frame);

/// Adds the options of `clearway run`. `options` outlive the command.
void add_run_options(CLI::App& command, RunOptions& options);

}  // namespace clearway::tool
