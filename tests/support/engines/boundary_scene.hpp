#pragma once

#include <vector>

#include "support/engines/engines.hpp"
#include "support/random_triangles.hpp"

namespace clearway::test {

/// Quanta around one place, at most `reach` away along each axis.
inline std::vector<Quantum> random_quanta(Random& random, std::size_t count, std::int32_t reach) {
  std::vector<Quantum> points(count);
  for (Quantum& q : points) {
    for (std::int32_t& value : q) {
      value = static_cast<std::int32_t>(below(random, static_cast<std::uint64_t>(2 * reach + 1))) -
              reach;
    }
  }
  return points;
}

/// Points around a place at which rounding decides.
struct Boundary {
  const char* name;
  double length;  ///< metres, of the model or of the way
  Vec3 offset;    ///< of everything from the origin
  double jitter;  ///< metres; about as large as the rounding of the coordinates
  Vec3 stretch = {1, 1, 1};
  bool is_way = false;
};

inline const Boundary kBoundaries[] = {
    {"near the origin", 3, {0, 0, 0}, 1e-15},
    {"a model small beside the radius", 1e-9, {0, 0, 0}, 4e-16},
    {"far from it", 3, {5e6, 2e6, 1e3}, 2e-9},
    {"very far from it", 3, {-3e12, 7e12, 1e9}, 1e-3},
    {"slightly not rigid", 3, {100, 200, 30}, 1e-13, {1.00009, 1.00008, 1.00009}},
    {"strongly not rigid", 3, {1e5, 2e5, 30}, 3e-11, {2.5, 0.4, 1.3}},
    {"a short way", 0.1, {0, 0, 0}, 2e-15, {1, 1, 1}, true},
    {"a way", 3, {0, 0, 0}, 4e-15, {1, 1, 1}, true},
    {"a way far from the origin", 3, {5e6, -2e6, 5e3}, 4e-9, {1, 1, 1}, true},
    {"a long way", 2e3, {0, 0, 0}, 1e-12, {1, 1, 1}, true},
    {"a long way far from the origin", 2e3, {5e6, -2e6, 5e3}, 4e-9, {1, 1, 1}, true},
    {"a way of 10,000 km", 1e7, {0, 0, 0}, 1e-8, {1, 1, 1}, true},
    {"an absurdly long way", 1e12, {0, 0, 0}, 1e-3, {1, 1, 1}, true},
    {"a tiny way", 1e-12, {1, -0.4, 1e-3}, 1e-15, {1, 1, 1}, true},
};

/// Model points on a line, at poses that hardly move, with environment points beyond the line's end
/// at the radius, give or take the jitter: as far from every sphere's centre as a collision can be.
/// On a way, the line lies across it, and the points are anywhere beside it.
inline EngineScene boundary_scene(Random& random, const Boundary& boundary,
                                  std::size_t model_points, std::size_t pose_count) {
  EngineScene scene;
  Query& query = scene.query;
  query.radius = uniform(random, 0.05, 2);
  const double line = boundary.is_way ? 1 : boundary.length;
  const Vec3 along = plus({}, line, random_direction(random));
  for (std::size_t i = 0; i < model_points; ++i) {
    query.model.vertices.push_back(
        plus({}, i < 2 ? 1.0 - static_cast<double>(i) : uniform(random, 0, 1), along));
  }
  const Pose base = stretched(random_rotation(random, boundary.offset), boundary.stretch);
  for (std::size_t i = 0; i < pose_count; ++i) {
    query.poses.push_back(base);
    for (double& p : query.poses.back().translation) {
      p += uniform(random, -1, 1) * boundary.jitter;
    }
  }
  const Pose& last = query.poses.back();
  Vec3 end = transform(last, query.model.vertices[0]);
  const Vec3 reach = difference(end, last.position());
  if (boundary.is_way) {
    const Vec3 other = random_direction(random);
    const Vec3 across{reach.y * other.z - reach.z * other.y, reach.z * other.x - reach.x * other.z,
                      reach.x * other.y - reach.y * other.x};
    query.poses = {base, base};
    for (int k = 0; k < 3; ++k) {
      query.poses[1].translation[k] += boundary.length / length_of(across) * across[k];
    }
    const Vec3 a = transform(query.poses[0], query.model.vertices[0]);
    const Vec3 b = transform(query.poses[1], query.model.vertices[0]);
    end = plus(a, uniform(random, 0.01, 0.99), difference(b, a));
  }
  const Vec3 at = plus(end, query.radius / length_of(reach), reach);
  const double quantum = boundary.jitter / 64;
  scene.quantisation = {{quantum, quantum, quantum}, {at.x, at.y, at.z}};
  scene.points = random_quanta(random, 200, 64);
  return scene;
}

}  // namespace clearway::test
