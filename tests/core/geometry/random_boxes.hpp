#pragma once

#include <algorithm>

#include "support/scenes.hpp"

namespace clearway::test {

/// A random box near a place, one in three sides of it flat.
inline Box random_box(Random& random, const Vec3& at, double size) {
  Box box{};
  for (int k = 0; k < 3; ++k) {
    box.lo[k] = at[k] + uniform(random, -size, size);
    box.hi[k] = below(random, 3) == 0 ? box.lo[k] : box.lo[k] + uniform(random, 0, size);
  }
  return box;
}

/// A random point of the box, on its border in about half of the axes.
inline Vec3 point_of(Random& random, const Box& box) {
  Vec3 p = random_point(random, box);
  for (int k = 0; k < 3; ++k) {
    const std::uint64_t kind = below(random, 4);
    if (kind == 0) p[k] = box.lo[k];
    if (kind == 1) p[k] = box.hi[k];
    p[k] = std::clamp(p[k], box.lo[k], box.hi[k]);
  }
  return p;
}

/// Near the origin, a kilometre away, or as far as a map projection's coordinates.
inline double how_far(int trial) { return trial % 3 == 0 ? 1 : trial % 3 == 1 ? 1e3 : 5e6; }

}  // namespace clearway::test
