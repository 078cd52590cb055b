#pragma once

#include <array>
#include <vector>

#include "clearway/query.hpp"
#include "support/memory_cloud.hpp"
#include "support/random_triangles.hpp"
#include "support/scenes.hpp"

namespace clearway::test {

using Triples = std::vector<std::array<std::uint32_t, 3>>;

/// Triangles of a test's model. A vertex that no triangle uses is among the vertices, as in files.
struct Surface {
  std::vector<Vec3> vertices{{9, 9, 9}};
  Triples triangles;

  void add(const Triangle& t) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    vertices.insert(vertices.end(), {t.a, t.b, t.c});
    triangles.push_back({first, first + 1, first + 2});
  }

  Triangle at(std::size_t index) const {
    const auto& [a, b, c] = triangles[index];
    return {vertices[a], vertices[b], vertices[c]};
  }
};

/// The surface of a box: twelve triangles over eight vertices.
inline Surface box_surface(const Box& box) {
  Surface surface;
  surface.vertices.clear();
  for (int i = 0; i < 8; ++i) {
    surface.vertices.push_back(
        {i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y, i & 4 ? box.hi.z : box.lo.z});
  }
  surface.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                       {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return surface;
}

/// A surface of `count` triangles of every shape within a box: large ones, needles, slivers, flat
/// ones, single places, tiny ones, and duplicates whose corners start elsewhere.
inline Surface random_surface(Random& random, const Box& box, std::size_t count) {
  Surface surface;
  const Vec3 extent{box.hi.x - box.lo.x, box.hi.y - box.lo.y, box.hi.z - box.lo.z};
  const double size = length_of(extent) + 1e-300;
  while (surface.triangles.size() < count) {
    const Vec3 a = random_point(random, box), b = random_point(random, box);
    const double g = uniform(random, -0.2, 1.2);
    Triangle t{a, b, random_point(random, box)};
    switch (below(random, 8)) {
      case 0:
        t.c = plus(a, g, difference(b, a));
        break;
      case 1:
        t.c = plus(plus(a, g, difference(b, a)), 1e-9 * size, random_direction(random));
        break;
      case 2:
        t.c = plus(a, 1e-13 * size, random_direction(random));
        break;
      case 3:
        t.b = t.c = a;
        break;
      case 4:
        t.b = plus(a, 1e-9, random_direction(random));
        t.c = plus(a, 1e-9, random_direction(random));
        break;
      case 5:
        t.b = plus(a, 0.1 * size, random_direction(random));
        t.c = plus(a, 0.1 * size, random_direction(random));
        break;
      case 6:
        if (!surface.triangles.empty()) {
          const Triangle& other = surface.at(below(random, surface.triangles.size()));
          t = below(random, 2) == 0 ? other : Triangle{other.b, other.c, other.a};
        }
        break;
      default:
        break;
    }
    surface.add(t);
  }
  return surface;
}

/// Random places on corners, edges and faces of the surface at random poses, and beside them at
/// about the radius: exactly, an ulp to either side, and anywhere near.
inline std::vector<Vec3> places_beside(Random& random, const Surface& surface,
                                       const std::vector<Pose>& poses, double radius,
                                       std::size_t count) {
  std::vector<Vec3> places;
  while (places.size() < count) {
    const Triangle t = transform(poses[below(random, poses.size())],
                                 surface.at(below(random, surface.triangles.size())));
    const Vec3 on = random_place_at(random, t);
    const double by = radius * (below(random, 3) == 0   ? 1 + uniform(random, -4, 4) * 0x1p-52
                                : below(random, 2) == 0 ? uniform(random, 0, 2)
                                                        : 0);
    places.push_back(plus(on, by, random_direction(random)));
  }
  return places;
}

}  // namespace clearway::test
