#pragma once

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/geometry/inside.hpp"
#include "support/engines/engines.hpp"
#include "support/scenes.hpp"
#include "support/solid_scene.hpp"

/// Scenes for the engines. All of them follow from their seeds.
namespace clearway::test {

enum class Kind { kPoints, kSurface, kSolids };

inline const Box kRoom{{-4, -3, -1}, {5, 4, 2}};
inline const Box kPart{{-0.6, -0.4, -0.3}, {0.7, 0.5, 0.2}};

inline Quantisation quantisation_of(double scale, const Vec3& offset = {0, 0, 0}) {
  return {{scale, scale, scale}, {offset.x, offset.y, offset.z}};
}

inline Surface moved_by(const Surface& body, const Vec3& by) {
  return mapped(body, [&](const Vec3& v) { return plus(v, 1, by); });
}

inline Model surface_model(const Surface& surface) { return {surface.vertices, surface.triangles}; }

inline Model solid_model(const Bodies& bodies) {
  return {bodies.surface.vertices, bodies.surface.triangles, bodies.solid_of};
}

inline Model solid_model(const Surface& body) {
  Bodies bodies;
  bodies.add(body);
  return solid_model(bodies);
}

/// The same model with the vertices multiplied by `by`, and all else of the scene as well.
inline void scale_up(EngineScene& scene, double by) {
  for (double& scale : scene.quantisation.scale) scale *= by;
  for (Vec3& m : scene.query.model.vertices) m = plus({}, by, m);
  for (Pose& pose : scene.query.poses) {
    for (double& t : pose.translation) t *= by;
  }
  scene.query.radius *= by;
}

/// A random cloud in kRoom, a model of a kind and a random path through the room.
struct PlainScene : EngineScene {
  explicit PlainScene(Kind kind = Kind::kPoints) {
    quantisation = quantisation_of(1e-4);
    const bool is_points = kind == Kind::kPoints;
    set_points(random_points(random, kRoom, is_points ? 3000 : 400));
    if (is_points) query.model = random_points(random, kPart, 60);
    if (kind == Kind::kSurface) query.model = surface_model(random_surface(random, kPart, 30));
    if (kind == Kind::kSolids) query.model = solid_model(box_surface(kPart));
    query.poses = smooth_path(random, kRoom, is_points ? 40 : 25);
    query.radius = is_points ? 0.3 : 0.2;
  }

  void set_points(const std::vector<Vec3>& places) { points = quantise(places, quantisation); }
  void add_point(const Vec3& at) { points.push_back(quantise(std::vector{at}, quantisation)[0]); }

  Random random{7};
};

inline Box random_box(Random& random, double largest) {
  Box box{};
  for (int k = 0; k < 3; ++k) {
    box.lo[k] = -uniform(random, 0, largest);
    box.hi[k] = below(random, 5) == 0 ? box.lo[k] : uniform(random, 0, largest);
  }
  return box;
}

/// A path of one of ten sorts.
inline std::vector<Pose> random_path(Random& random, const Box& box, std::size_t count) {
  std::vector<Pose> poses = smooth_path(random, box, count);
  const std::uint64_t sort = below(random, 10);
  const double noise = below(random, 2) == 0 ? 0 : 0.02;
  double heading = uniform(random, 0, 6);
  for (std::size_t i = 0; i < count; ++i) {
    Pose& pose = poses[i];
    heading += uniform(random, -0.1, 0.1);
    if (sort == 0) pose = random_rotation(random, random_point(random, box));  // jumps
    if (sort == 1 && below(random, 4) == 0) pose = poses[below(random, count)];
    if (sort == 2) pose = printed_with_six_digits(pose);
    if (sort == 3) pose = stretched(pose, {uniform(random, 0.2, 3), uniform(random, -3, 3), 1});
    if (sort == 4) pose = rotation({0, 1, 0}, uniform(random, 0, 6), {0.1, 0.2, 0.3});
    if (sort == 5 && i % 2 == 1) pose.translation[0] += 1e7;    // jumps far away and back
    if (sort == 6) pose.rotation[1] += 1.5 * pose.rotation[0];  // is sheared
    if (sort != 7) continue;                                    // level ground, with a little noise
    const Vec3 axis{noise * uniform(random, -1, 1), noise * uniform(random, -1, 1), 1};
    pose = rotation(axis, heading, {pose.translation[0], pose.translation[1], 0});
  }
  if (below(random, 10) == 0) drive_back(poses);
  if (below(random, 10) == 0) repeat_each(poses, 3);
  if (below(random, 20) == 0) stretch(poses, {3, 0, 1});
  return poses;
}

/// A model of a kind within about `size` of its origin.
inline Model random_model(Random& random, Kind kind, double size, bool is_simple) {
  const Box part = random_box(random, size);
  if (kind == Kind::kPoints) {
    std::vector<Vec3> points = random_points(random, part, 1 + below(random, 80));
    if (below(random, 4) == 0) {
      for (Vec3& p : points) p = points[below(random, points.size())];
    }
    return points;
  }
  if (kind == Kind::kSurface) {
    return surface_model(random_surface(random, part, 1 + below(random, 30)));
  }
  Bodies bodies;
  for (std::uint64_t i = 0; i <= below(random, 3); ++i) {
    bodies.add(moved_by(random_body(random, size, is_simple), random_point(random, part)),
               below(random, 5) > 0);
  }
  if (below(random, 2) == 0) bodies.add(random_surface(random, part, 5), false);
  return solid_model(bodies);
}

/// Random places on the elements of the model at random poses, and beside them at about the radius:
/// exactly, an ulp to either side, and anywhere near.
inline std::vector<Vec3> places_beside(Random& random, const Query& query, double radius,
                                       std::size_t count) {
  Surface surface{query.model.vertices, query.model.triangles};
  if (surface.triangles.empty()) {
    for (std::uint32_t i = 0; i < surface.vertices.size(); ++i) {
      surface.triangles.push_back({i, i, i});
    }
  }
  return places_beside(random, surface, query.poses, radius, count);
}

/// A height that matters as a floor: that of a point near the model at one of the poses, or one ulp
/// beside it, or any height of the model.
inline double floor_that_matters(Random& random, const EngineScene& scene, double size) {
  const double reach = size + scene.query.radius;
  const double any = uniform(random, -reach, reach);
  if (below(random, 4) == 0) return any;
  const std::vector<Vec3> positions = positions_of(scene.points, scene.quantisation);
  for (int tries = 0; tries < 200; ++tries) {
    const Pose& pose = scene.query.poses[below(random, scene.query.poses.size())];
    const Vec3 x = pulled_back(pose, positions[below(random, positions.size())]);
    if (!(std::abs(x.x) <= reach && std::abs(x.y) <= reach && std::abs(x.z) <= reach)) continue;
    constexpr double kFar = std::numeric_limits<double>::infinity();
    const std::uint64_t ulp = below(random, 3);
    return ulp == 0 ? x.z : std::nextafter(x.z, ulp == 1 ? kFar : -kFar);
  }
  return any;
}

/// A random scene with a model of the kind: of any size, near the origin or far from it; its points
/// spread, in clusters or duplicates, at the radius from the model and in clumps that are small
/// beside the radius. One in three has a floor, one in four has points to be ignored.
inline EngineScene random_scene(Random& random, Kind kind) {
  EngineScene scene;
  const double size = std::exp(uniform(random, -3, 4));
  const Box room = random_box(random, size);
  const double part = size * uniform(random, 0.01, 0.4);
  const bool is_points = kind == Kind::kPoints, is_large = below(random, 50) == 0;
  scene.query.model = random_model(random, kind, part, !is_large);
  scene.query.poses = random_path(random, room,
                                  1 + below(random, is_points  ? 60
                                                    : is_large ? 40
                                                               : 12));
  // A radius far below the size of a surface takes a large field.
  scene.query.radius = is_points || is_large ? size * std::exp(uniform(random, -5, 0))
                                             : part * std::exp(uniform(random, -0.7, 1.2));
  scene.quantisation = {{size * 1e-6, size * 1e-6, size * 2e-6}, {0, 0, 0}};

  std::vector<Vec3> places = random_points(random, room, 1 + below(random, is_points ? 800 : 60));
  const std::uint64_t sort = below(random, 4);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vec3& centre = places[i % 7 % places.size()];
    if (sort == 0) places[i] = plus(places[i], 0.9, difference(centre, places[i]));
    if (sort == 1) places[i] = places[below(random, places.size())];
  }
  for (const Vec3& place :
       places_beside(random, scene.query, scene.query.radius, is_points ? 60 : 30)) {
    places.push_back(place);
  }
  for (std::size_t clump = below(random, 3); clump > 0; --clump) {
    const Vec3 middle = places[below(random, places.size())];
    const double half = scene.query.radius * uniform(random, 0.05, 0.8);
    for (int i = 0; i < 64; ++i) {
      places.push_back(
          plus(middle, 1, random_point(random, {{-half, -half, -half}, {half, half, half}})));
    }
  }
  scene.points = quantise(places, scene.quantisation);
  if (below(random, 3) == 0) {
    scene.move_far_away({uniform(random, -5e6, 5e6), uniform(random, -5e6, 5e6), 1e3});
  }
  if (below(random, 3) == 0) scene.query.floor = floor_that_matters(random, scene, part);
  if (below(random, 4) == 0) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      scene.classes.push_back(static_cast<std::uint8_t>(below(random, 3)));
    }
    scene.query.ignore_classes = {1};
    const Vec3 at = random_point(random, room);
    if (below(random, 2) == 0) scene.query.ignore_boxes = {Box{at, at}.grown(size / 4)};
  }
  return scene;
}

/// One way to pack the points, chosen at random.
inline MemoryCloudOptions random_packing(Random& random) {
  return {std::uint32_t{64} << below(random, 6),
          static_cast<std::uint32_t>(300 * below(random, 2))};
}

}  // namespace clearway::test
