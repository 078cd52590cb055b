#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "clearway/conflicts.hpp"
#include "clearway/model.hpp"
#include "clearway/result.hpp"
#include "clearway/trajectory.hpp"
#include "cli/support/lengths.hpp"

namespace CLI {
class App;
}

namespace clearway::tool {

/// What commands that find conflicts take beside the results.
struct ConflictCommand {
  ConflictOptions find;
  TrajectoryOptions trajectory_options;
  LengthOptions lengths;
};

/// --gap, --min-points, --split, --memory, --threads and the options of trajectories.
void add_conflict_options(CLI::App& command, ConflictCommand& options);

/// --forward and --up.
void add_axis_options(CLI::App& command, ConflictOptions& options);

/// The poses of a result. Warnings are told.
std::vector<Pose> read_poses(const std::filesystem::path& path, TrajectoryOptions options,
                             const Result& result);

/// What the model of a result was searched as.
ModelAs model_kind_of(const Result& result);

/// The points of the model that a result is of. Throws InputError for another model.
std::vector<Vec3> read_model_of(const std::filesystem::path& path, const ModelOptions& options,
                                const Result& result);

}  // namespace clearway::tool
