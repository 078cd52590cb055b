#pragma once

#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "support/surface_scene.hpp"

/// Closed bodies as meshes. Every test seeds its own generator.
namespace clearway::test {

/// A model of several bodies.
struct Bodies {
  Surface surface{{}, {}};
  std::vector<std::uint32_t> solid_of;
  std::uint32_t solids = 0;

  void add(const Surface& body, bool is_solid = true) {
    const auto first = static_cast<std::uint32_t>(surface.vertices.size());
    surface.vertices.insert(surface.vertices.end(), body.vertices.begin(), body.vertices.end());
    for (const auto& [a, b, c] : body.triangles) {
      surface.triangles.push_back({a + first, b + first, c + first});
      solid_of.push_back(is_solid ? solids : kNoSolid);
    }
    if (is_solid) ++solids;
  }

  Query query(std::vector<Pose> poses, double radius) const {
    Query query{surface.vertices, std::move(poses), {radius}};
    query.model.triangles = surface.triangles;
    query.model.solid_of = solid_of;
    return query;
  }
};

/// The body with `map` applied to each vertex.
template <typename Map>
Surface mapped(Surface body, Map map) {
  for (Vec3& v : body.vertices) v = map(v);
  return body;
}

inline Surface turned_inwards(Surface body) {
  for (auto& triangle : body.triangles) std::swap(triangle[0], triangle[1]);
  return body;
}

inline Surface tetrahedron(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return {{a, b, c, d}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

/// A sphere of radius 1 about the origin: an octahedron whose triangles are divided in four
/// `levels` times.
inline Surface unit_sphere(int levels) {
  Surface body{
      {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
      {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(body.vertices.size()));
      if (is_new) {
        const Vec3 sum = plus(body.vertices[a], 1, body.vertices[b]);
        body.vertices.push_back(plus({}, 1 / length_of(sum), sum));
      }
      return at->second;
    };
    Triples finer;
    for (const auto& [a, b, c] : body.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    body.triangles = finer;
  }
  return body;
}

/// A torus around the z axis, with a tube of radius `thin` at a distance of 1.
inline Surface torus(double thin, std::uint32_t around, std::uint32_t along_tube) {
  Surface body{{}, {}};
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t j = 0; j < along_tube; ++j) {
      const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / along_tube;
      const double beside = 1 + thin * std::cos(v);
      body.vertices.push_back({beside * std::cos(u), beside * std::sin(u), thin * std::sin(v)});
      const std::uint32_t here = i * along_tube, next = (i + 1) % around * along_tube;
      const std::uint32_t up = (j + 1) % along_tube;
      body.triangles.push_back({here + j, next + j, next + up});
      body.triangles.push_back({here + j, next + up, here + up});
    }
  }
  return body;
}

/// A random body that does not cross itself, within about `size` of the origin, turned anyhow, from
/// as wide as high down to needles and sheets that are 1e-9 times as thick. is_simple: it has at
/// most 40 triangles.
inline Surface random_body(Random& random, double size, bool is_simple = false) {
  const Pose turn = random_rotation(random, {0, 0, 0});
  const auto thinness = [&] {
    return below(random, 2) == 0 ? 1 : std::pow(10, -uniform(random, 0, 9));
  };
  const Vec3 thin{1, thinness(), thinness()};
  const Box ball{{-1, -1, -1}, {1, 1, 1}};
  Surface body{{}, {}};
  switch (below(random, 4)) {
    case 0:
      body = tetrahedron(random_point(random, ball), random_point(random, ball),
                         random_point(random, ball), random_point(random, ball));
      break;
    case 1:
      body = box_surface({{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}});
      break;
    case 2: {
      body = unit_sphere(static_cast<int>(below(random, is_simple ? 2 : 3)));
      for (Vec3& v : body.vertices) v = plus({}, below(random, 8) == 0 ? 0.05 : 1, v);
      break;
    }
    default:
      body = torus(uniform(random, 0.1, 0.5),
                   static_cast<std::uint32_t>(3 + below(random, is_simple ? 3 : 8)),
                   static_cast<std::uint32_t>(3 + below(random, is_simple ? 2 : 5)));
      break;
  }
  if (below(random, 2) == 0) body = turned_inwards(body);
  return mapped(body, [&](const Vec3& v) {
    return transform(turn, Vec3{size * thin.x * v.x, size * thin.y * v.y, size * thin.z * v.z});
  });
}

}  // namespace clearway::test
