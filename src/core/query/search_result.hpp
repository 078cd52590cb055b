#pragma once

#include <cstdint>
#include <optional>

#include "core/query/clearance_set.hpp"
#include "core/query/hit_set.hpp"
#include "core/query/last_poses.hpp"
#include "core/query/profile_set.hpp"

namespace clearway {

/// The answer of an engine for every entry of a cloud.
struct SearchResult {
  HitSet hits;
  ClearanceSet clearances;  ///< no entries unless asked for
  ProfileSet profile = {};  ///< no poses unless asked for
  /// Number of ignored points in the cells that were searched, without those of a journal.
  std::uint64_t ignored_points = 0;
  /// Set after a search for them, if first poses were asked for
  std::optional<LastPoses> last_poses = {};
};

}  // namespace clearway
