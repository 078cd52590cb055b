#pragma once

#include "core/clearance_set.hpp"
#include "core/hit_set.hpp"

namespace clearway {

/// What an engine says of every slot of a cloud.
struct Answer {
  HitSet hits;
  ClearanceSet clearances;  ///< without slots unless asked for
};

}  // namespace clearway
