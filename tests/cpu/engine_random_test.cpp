// Every engine against brute force on hundreds of small random scenes.
#include "engine_scenes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

#ifdef CLEARWAY_SANITIZED
constexpr std::uint64_t kScenes = 100;  // with sanitizers each takes tens of times as long
#else
constexpr std::uint64_t kScenes = 600;
#endif

/// A room with two levels of even ground, along which many points are nearly the nearest at every
/// pose; or a long load between walls between which it just fits.
PlainScene slow_scene(std::uint64_t seed) {
  const Kind kind{static_cast<int>(seed % 3)};
  PlainScene scene(kind);
  scene.random = Random(seed);
  Random& random = scene.random;
  EngineScene& all = scene;
  std::vector<Vec3> places = random_points(random, kRoom, 100);
  if (seed % 2 == 0) {
    for (const double height : {-0.35, 0.02}) {
      const auto ground = random_points(random, {{-4, -1, height}, {4, 1, height + 0.01}}, 150);
      places.insert(places.end(), ground.begin(), ground.end());
    }
    if (kind == Kind::kPoints) all.query.model.vertices.resize(25);
    all.query.radius = 0.1;
    all.query.poses = random_slow_path(random, 240);
  } else {
    const Surface load = box_surface({{-3, -0.4, -0.3}, {3, 0.5, 0.2}});
    if (kind == Kind::kSurface) all.query.model = surface_model(load);
    if (kind == Kind::kSolids) all.query.model = solid_model(load);
    constexpr double kBends[] = {0, 1e-3, 0.05};
    all.query.radius = 0.1;
    all.query.poses = slow_path(400, kBends[below(random, 3)]);
    for (int i = 0; i < 250; ++i) {
      const double off = i % 5 == 0 ? -0.3 : all.query.radius + uniform(random, -0.01, 0.1);
      const double x = uniform(random, -1, 6);
      places.push_back(i % 2 == 0 ? Vec3{x, 0.5 + off, uniform(random, -0.3, 0.2)}
                                  : Vec3{x, uniform(random, -0.4, 0.5), 0.2 + off});
    }
    if (below(random, 4) == 0) stop_at(all.query.poses, 200, 100);
    if (below(random, 4) == 0) drive_back(all.query.poses);
  }
  scene.set_points(places);
  if (below(random, 5) == 0) stretch(all.query.poses, {2.5, 0.3, 1.7});
  if (below(random, 5) == 0) print_with_six_digits(all.query.poses);
  if (below(random, 4) == 0) scene.move_far_away({5e6, 2e6, 1e3});
  if (below(random, 3) == 0) all.query.floor = below(random, 2) == 0 ? -0.3 : 0.15;
  return scene;
}

}  // namespace

TEST_CASE("random scenes with every kind of model") {
  std::uint64_t with_hits = 0, with_floor = 0, less = 0;
  for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    EngineScene scene = random_scene(random, Kind{static_cast<int>(seed % 3)});
    const std::uint64_t hits =
        check_engines(scene, {.packings = {random_packing(random)}}).colliding();
    with_hits += hits > 0;
    if (!scene.query.floor) continue;
    ++with_floor;
    scene.query.floor.reset();
    less += hits < Expected(scene).colliding();
  }
  CHECK(with_hits > kScenes / 3);
  CHECK(less > with_floor / 3);
}

TEST_CASE("slow paths, on which bounds last") {
  std::uint64_t with_hits = 0;
  constexpr std::uint64_t kSlowScenes = kScenes / 10;
  for (std::uint64_t seed = 1; seed <= kSlowScenes; ++seed) {
    CAPTURE(seed);
    PlainScene scene = slow_scene(seed);
    const Asked asked{.reach = seed % 4 == 0 ? 2.0 : 0.5,
                      .packings = {random_packing(scene.random)}};
    with_hits += check_engines(scene, asked).colliding() > 0;
  }
  CHECK(with_hits > kSlowScenes / 3);
}
