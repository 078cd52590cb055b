#pragma once

#include "core/query/clearance_set.hpp"
#include "core/query/hit_set.hpp"
#include "core/query/profile_set.hpp"

namespace clearway {

/// What an engine says of every entry of a cloud.
struct SearchResult {
  HitSet hits;
  ClearanceSet clearances;  ///< without entries unless asked for
  ProfileSet profile = {};  ///< without poses unless asked for
};

}  // namespace clearway
