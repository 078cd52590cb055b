#pragma once

#include <cstdint>

#include "core/query/clearance_set.hpp"
#include "core/query/hit_set.hpp"
#include "core/query/profile_set.hpp"

namespace clearway {

/// What an engine says of every entry of a cloud.
struct SearchResult {
  HitSet hits;
  ClearanceSet clearances;  ///< without entries unless asked for
  ProfileSet profile = {};  ///< without poses unless asked for
  /// Of the cells that were searched, those of a journal not included.
  std::uint64_t ignored_points = 0;
};

}  // namespace clearway
