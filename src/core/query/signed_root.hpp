#pragma once

#include <cmath>

namespace clearway {

/// The distance that belongs to a squared distance; both are below 0 inside solids
/// (docs/design/solids.md).
inline double signed_root(double squared) {
  return squared < 0 ? -std::sqrt(-squared) : std::sqrt(squared);
}

}  // namespace clearway
