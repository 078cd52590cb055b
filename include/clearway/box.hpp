#pragma once

#include "clearway/vec3.hpp"

namespace clearway {

/// Axis-aligned box, closed on both sides, metres.
struct Box {
  Vec3 lo, hi;
  friend bool operator==(const Box&, const Box&) = default;
};

}  // namespace clearway
