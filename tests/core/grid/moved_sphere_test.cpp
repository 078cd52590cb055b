// Spheres of groups, at a pose and over a run of poses, against single points where their bound is
// tight: beyond the end of a line of model points, at the radius.
#include "core/grid/grid_scene.hpp"
#include "core/grid/grid_search.hpp"
#include "support/catch.hpp"
#include "support/engines/boundary_scene.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("spheres are dismissed only where none of their points hits") {
  const auto poses = GENERATE(as<std::size_t>(), 1, 2, 16);
  Random random(41);
  std::uint64_t hits = 0, points = 0;
  for (int i = 0; i < 500; ++i) {
    const Boundary& boundary = kBoundaries[i % 6];
    const EngineScene at_radius = boundary_scene(random, boundary, 20, poses);
    const Query& query = at_radius.query;
    const MotionTree motion(query.poses, ModelGroups(query.model.vertices).box());
    const MemoryCloud cloud({}, {{1, 1, 1}, {0, 0, 0}});
    const GridScene scene(query, motion, cloud);
    const GridSceneView& view = scene.view();
    const GridNode& run = scene.nodes()[scene.runs()[0]];
    REQUIRE(run.count == poses);
    for (const Vec3& e : positions_of(at_radius.points, at_radius.quantisation)) {
      bool any = false;
      for (std::uint32_t pose = 0; pose < poses; ++pose) {
        const bool hit = std::ranges::any_of(query.model.vertices, [&](const Vec3& m) {
          return collides(e, transform(query.poses[pose], m), query.radius);
        });
        const MovedSphere at_pose = moved(view, view.groups[0], pose, view.bounds[pose].spread);
        if (hit) REQUIRE(may_touch({e, e}, at_pose));
        any = any || hit;
      }
      if (any) REQUIRE(may_touch({e, e}, moved(view, view.parts[0], run.mid, run.spread)));
      hits += any;
      ++points;
    }
  }
  CHECK(hits > points / 20);
  CHECK(hits < points - points / 20);
}
