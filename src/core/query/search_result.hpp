#pragma once

#include <cstdint>
#include <optional>

#include "core/query/clearance_set.hpp"
#include "core/query/hit_set.hpp"
#include "core/query/last_poses.hpp"
#include "core/query/profile_set.hpp"

namespace clearway {

/// What an engine says of every entry of a cloud.
struct SearchResult {
  HitSet hits;
  ClearanceSet clearances;  ///< without entries unless asked for
  ProfileSet profile = {};  ///< without poses unless asked for
  /// Of the cells that were searched, those of a journal not included.
  std::uint64_t ignored_points = 0;
  std::optional<LastPoses> last_poses = {};  ///< where first poses were asked for, once searched
};

}  // namespace clearway
