// Answers within a tolerance: wrong only where the exact distance is that near to the radius.
#include "engine_scenes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A scene of places, with quanta as fine as they can be.
EngineScene scene_of(const std::vector<Vec3>& places, const Query& query) {
  double reach = 1e-9;
  for (const Vec3& p : places) reach = std::max(reach, length_of(difference(p, places[0])));
  const Quantisation quantisation = quantisation_of(reach / (1 << 30), places[0]);
  return {quantise(places, quantisation), quantisation, query};
}

/// Moves each point of a scene to about the radius from the model: out to twice the tolerance and
/// a few ulps to either side of it.
EngineScene at_radius(Random& random, const Query& query, double tolerance, std::size_t count) {
  std::vector<Vec3> places;
  for (const Vec3& on : places_beside(random, query, 0, count)) {
    const double side = below(random, 2) == 0 ? -1 : 1;
    const double distance =
        below(random, 3) == 0
            ? (query.radius + side * tolerance) * (1 + uniform(random, -4, 4) * 0x1p-52)
            : query.radius + uniform(random, -2, 2) * tolerance;
    places.push_back(plus(on, distance, random_direction(random)));
  }
  return scene_of(places, query);
}

}  // namespace

// Everything that is left out lies on one line, as far away as the tolerance allows, and so do the
// points beyond its end: here every part of the tolerance is spent.
TEST_CASE("distances that grow by all of the tolerance") {
  Random random(3);
  std::uint64_t differing = 0;
  for (int trial = 0; trial < 80; ++trial) {
    CAPTURE(trial);
    Query query{{{0, 0, 0}}, {translation({0, 0, 0})}, {uniform(random, 0.1, 2)}};
    const double tolerance = query.radius * uniform(random, 0.01, 0.4);
    const Vec3 along = random_direction(random);
    const double step = tolerance * uniform(random, 0.2, 1.05);
    const double move = tolerance * uniform(random, 0.2, 1.05) * (below(random, 2) == 0 ? -1 : 1);
    for (std::uint64_t i = below(random, 3); i-- > 0;) {
      query.model.vertices.push_back(plus(query.model.vertices.back(), step, along));
    }
    for (std::uint64_t i = below(random, 3); i-- > 0;) {
      query.poses.push_back(translation(plus(query.poses.back().position(), move, along)));
    }
    std::vector<Vec3> places;
    for (int i = 0; i < 120; ++i) {
      const Pose& pose = below(random, 2) == 0 ? query.poses[0] : query.poses.back();
      places.push_back(plus(transform(pose, query.model.vertices.back()),
                            query.radius + uniform(random, -2, 2) * tolerance, along));
    }
    differing += check_tolerance(scene_of(places, query), tolerance).differing;
  }
  CHECK(differing > 300);  // the tolerance is made use of
}

// Everything that is left out lies on one line again, and the field's candidate is one of many
// points just too far to be taken, so that bounds settle what the thinning moved too far.
TEST_CASE("a tolerance spent on thinning and then on bounds") {
  Random random(4);
  std::uint64_t differing = 0;
  for (int trial = 0; trial < 350; ++trial) {
    CAPTURE(trial);
    const double radius = uniform(random, 0.1, 2);
    const double tolerance = radius * uniform(random, 0.4, 0.65);
    const Vec3 along = random_direction(random);
    const Vec3 step = plus({}, tolerance * uniform(random, 0.3, 1.02), along);
    const double move = tolerance * uniform(random, 0.3, 1.02);
    std::vector<Vec3> model{{0, 0, 0}, step};
    const Vec3 at = plus(step, radius - uniform(random, 0.4, 1.5) * tolerance, along);
    for (int i = 0; i < 20; ++i) {
      const double farther = tolerance * uniform(random, 1.02, 1.2);
      model.push_back(plus(at, radius + farther + 2 * move, random_direction(random)));
    }
    std::vector<Vec3> places;
    for (int i = 0; i < 50; ++i) {
      places.push_back(plus(at, 0.05 * tolerance, random_direction(random)));
    }
    const std::vector<Pose> poses{translation({0, 0, 0}), translation(plus({}, -move, along))};
    differing += check_tolerance(scene_of(places, {model, poses, {radius}}), tolerance).differing;
  }
  CHECK(differing > 100);
}

TEST_CASE("a tolerance in scenes of many kinds") {
  std::uint64_t differing = 0, colliding = 0;
  for (std::uint64_t seed = 1; seed <= 90; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    EngineScene scene = random_scene(random, seed % 3 == 0 ? Kind::kSurface : Kind::kPoints);
    scene.query.floor.reset();
    scene.query.ignore_classes.clear();
    const double share = seed % 9 == 0 ? 1e-19 : std::exp(uniform(random, -9, -0.05));
    const double tolerance = scene.query.radius * share;  // also one below every rounding
    // Stops, and poses that stand for each other
    for (std::size_t i = scene.query.poses.size(); seed % 4 == 0 && i-- > 0;) {
      scene.query.poses.push_back(scene.query.poses[i]);
      scene.query.poses.back().translation[0] += 0.3 * tolerance;
    }
    const ToleratedResults found =
        check_tolerance(at_radius(random, scene.query, tolerance, 300), tolerance);
    differing += found.differing;
    colliding += found.colliding;
  }
  CHECK(colliding > 1000);
  CHECK(differing > 100);
}

TEST_CASE("a tolerance to the last digits") {
  Random random(13);
  for (const double tolerance : {0.05, 1e-3, 1e-9, 1e-15}) {
    for (int trial = 0; trial < 12; ++trial) {
      const Query query{
          {{0, 0, 0}}, {translation({uniform(random, 0, 1e-3), 0, 0})}, {uniform(random, 0.06, 1)}};
      const double side = trial % 2 == 0 ? -1 : 1;
      const Vec3 at = plus(query.poses[0].position(), query.radius + side * tolerance,
                           random_direction(random));
      EngineScene scene{{}, quantisation_of(0x1p-55, at), query};
      for (int i = 0; i < 300; ++i) {
        Quantum& q = scene.points.emplace_back();
        for (auto& value : q) value = static_cast<std::int32_t>(below(random, 65)) - 32;
      }
      check_tolerance(scene, tolerance);
    }
  }
}

TEST_CASE("a tolerance where model and environment are lattices") {
  Query query{{}, {}, {0.25}};
  for (int i = 0; i < 12 * 12; ++i) {
    query.model.vertices.push_back({0.125 * (i % 12), 0.125 * (i / 12), 0});
  }
  std::vector<Vec3> places;
  for (int i = 0; i < 16 * 16 * 8; ++i) {
    places.push_back({0.125 * (i % 16) - 0.25, 0.125 * (i / 16 % 16) - 0.25, 0.125 * (i / 256)});
  }
  for (int i = 0; i < 40; ++i) query.poses.push_back(translation({0.03125 * i, 0, 0.015625 * i}));
  for (const double tolerance : {0.03125, 0.0625, 0.125, 0.2}) {
    CHECK(check_tolerance(scene_of(places, query), tolerance).colliding > 100);
  }
}
