#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"

namespace clearway {

struct CompareOptions {
  int threads = 0;  ///< 0: all
  int repetitions = 3;
  bool peer = true;  ///< also nanoflann
};

/// Times run_kdtree and nanoflann's radiusSearch on the same points and query, `repetitions`
/// times each, and compares their sets. `points` are the cloud's positions by slot, the used ones
/// only, in the order of their slots.
nlohmann::json compare_engines(const PackedCloud& cloud, std::span<const Vec3> points,
                               const Query& query, const CompareOptions& options);

/// The positions of a cloud's used slots, in order.
std::vector<Vec3> positions_by_slot(const PackedCloud& cloud);

}  // namespace clearway
