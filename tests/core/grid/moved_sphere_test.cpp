// Spheres of groups, at a pose and over a run of poses, against single points where their bound is
// tight.
#include <cmath>

#include "core/grid/grid_scene.hpp"
#include "core/grid/grid_search.hpp"
#include "support/catch.hpp"
#include "support/memory_cloud.hpp"
#include "support/scenes.hpp"

using namespace clearway;

namespace {

struct Place {
  Vec3 offset;
  double jitter;  ///< metres; about as large as the rounding of the coordinates
  Vec3 stretch;
};

/// Checks a model on a line at poses that hardly move, with points beyond its end at the radius: as
/// far from a sphere's centre as a hit can be. Returns the number of hits.
std::uint64_t check_line(Random& random, const Place& place, std::size_t pose_count) {
  const double radius = uniform(random, 0.05, 2);
  const Vec3 along = random_direction(random);
  std::vector<Vec3> model;
  for (int i = 0; i < 20; ++i) {
    const double t = i == 0 ? -1.5 : i == 1 ? 1.5 : uniform(random, -1.5, 1.5);
    model.push_back({along.x * t, along.y * t, along.z * t});
  }
  const Pose base = stretched(random_rotation(random, place.offset), place.stretch);
  std::vector<Pose> poses(pose_count, base);
  for (Pose& pose : poses) {
    for (double& p : pose.translation) p += uniform(random, -1, 1) * place.jitter;
  }
  const Query query{model, poses, {.radius = radius}};
  const MotionTree motion(poses, ModelGroups(model).box());
  const MemoryCloud cloud({}, {{1, 1, 1}, {0, 0, 0}});
  const GridScene scene(query, motion, cloud);
  const GridSceneView& view = scene.view();
  const GridNode& run = scene.nodes()[scene.runs()[0]];
  REQUIRE(run.count == pose_count);

  const Vec3 end = transform(poses.back(), model[1]), start = transform(poses.back(), model[0]);
  const Vec3 reach = difference(end, start);
  const double length = std::sqrt(squared_length(reach.x, reach.y, reach.z));
  std::uint64_t hits = 0;
  for (int i = 0; i < 200; ++i) {
    Vec3 e{};
    for (int k = 0; k < 3; ++k) {
      e[k] = end[k] + reach[k] / length * radius + uniform(random, -1, 1) * place.jitter;
    }
    bool any = false;
    for (std::uint32_t pose = 0; pose < pose_count; ++pose) {
      bool hit = false;
      for (const Vec3& m : model) hit = hit || collides(e, transform(poses[pose], m), radius);
      if (hit)
        REQUIRE(may_touch({e, e}, moved(view, view.groups[0], pose, view.bounds[pose].spread)));
      any = any || hit;
    }
    if (any) REQUIRE(may_touch({e, e}, moved(view, view.parts[0], run.mid, run.spread)));
    hits += any;
  }
  return hits;
}

}  // namespace

TEST_CASE("spheres are dismissed only where none of their points hits") {
  const auto poses = GENERATE(as<std::size_t>(), 1, 2, 16);
  Random random(41);
  std::uint64_t hits = 0, points = 0;
  for (const Place& place :
       {Place{{0, 0, 0}, 1e-15, {1, 1, 1}}, Place{{5e6, 2e6, 1e3}, 2e-9, {1, 1, 1}},
        Place{{-3e12, 7e12, 1e9}, 1e-3, {1, 1, 1}},
        Place{{100, 200, 30}, 1e-13, {1.00009, 1.00008, 1.00009}},
        Place{{1e5, 2e5, 30}, 3e-11, {2.5, 0.4, 1.3}}}) {
    for (int i = 0; i < 100; ++i, points += 200) hits += check_line(random, place, poses);
  }
  CHECK(hits > points / 20);
  CHECK(hits < points - points / 20);
}
