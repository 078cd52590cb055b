#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "core/cloud/packed_cloud.hpp"

namespace clearway::bench {

/// The positions of a cloud's used slots, in order.
std::vector<Vec3> positions_by_slot(const PackedCloud& cloud);

struct CompareOptions {
  std::filesystem::path environment, model, trajectory;
  double radius = 0.1;
  std::uint64_t every_pose = 1;  ///< N: only every N-th pose is taken
  bool first_pose = false;       ///< whether the kdtree engine also finds first poses
  int threads = 0;               ///< 0: all cores
  int repetitions = 3;
  bool peer = true;  ///< whether nanoflann is timed too
};

/// Times run_kdtree and nanoflann's radiusSearch on the same points and query, `repetitions`
/// times each, and compares their sets.
nlohmann::json compare_engines(const CompareOptions& options);

}  // namespace clearway::bench
