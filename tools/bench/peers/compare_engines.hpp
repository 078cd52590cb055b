#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace clearway::bench {

struct CompareOptions {
  std::filesystem::path environment, model, trajectory;
  double radius = 0.1;
  std::uint64_t every_pose = 1;  ///< takes every N-th pose only
  bool first_pose = false;       ///< also finds first poses, the kdtree engine alone
  int threads = 0;               ///< 0: all
  int repetitions = 3;
  bool peer = true;  ///< also nanoflann
};

/// Times run_kdtree and nanoflann's radiusSearch on the same points and query, `repetitions`
/// times each, and compares their sets.
nlohmann::json compare_engines(const CompareOptions& options);

}  // namespace clearway::bench
