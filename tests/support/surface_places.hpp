#pragma once

#include <random>
#include <vector>

#include "io/models/mesh/mesh_builder.hpp"

namespace clearway::test {

inline Vec3 place_of(const Vec3& a, const Vec3& b, const Vec3& c, double s, double t) {
  Vec3 place{};
  for (int k = 0; k < 3; ++k) place[k] = a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]);
  return place;
}

/// Calls use(place) for places of every triangle: corners, middles of the sides and of the
/// triangle, along the sides, and `random` others.
template <typename Use>
void for_places(const TriangleMesh& mesh, int random, Use use) {
  std::mt19937_64 source(7);
  std::uniform_real_distribution<double> share(0, 1);
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3 &a = mesh.vertices[i], &b = mesh.vertices[j], &c = mesh.vertices[k];
    use(place_of(a, b, c, 1. / 3, 1. / 3));
    for (int step = 0; step < 16; ++step) {
      const double t = step / 16.0;
      use(place_of(a, b, c, t, 0));
      use(place_of(a, b, c, 0, t));
      use(place_of(a, b, c, t, 1 - t));
    }
    for (int n = 0; n < random; ++n) {
      double s = share(source), t = share(source);
      if (s + t > 1) {
        s = 1 - s;
        t = 1 - t;
      }
      use(place_of(a, b, c, s, t));
    }
  }
}

}  // namespace clearway::test
