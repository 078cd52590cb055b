#pragma once

#include "core/query/clearance_set.hpp"
#include "core/query/hit_set.hpp"

namespace clearway {

/// What an engine says of every slot of a cloud.
struct SearchResult {
  HitSet hits;
  ClearanceSet clearances;  ///< without slots unless asked for
};

}  // namespace clearway
