// Answers within a tolerance: wrong only where the exact distance is that near to the radius.
#include <cmath>

#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/engines/tolerance_runs.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// The point at `distance` from `from`.
Vec3 beside(const Vec3& from, const Vec3& direction, double distance) {
  return {from.x + distance * direction.x, from.y + distance * direction.y,
          from.z + distance * direction.z};
}

/// A quantisation whose integers have some room beyond the points.
Quantisation quantisation_of(const std::vector<Vec3>& points) {
  Quantisation quantisation{};
  for (int k = 0; k < 3; ++k) {
    double reach = 1e-9;
    quantisation.offset[k] = points[0][k];
    for (const Vec3& p : points) reach = std::max(reach, std::abs(p[k] - points[0][k]));
    quantisation.scale[k] = reach / (1 << 30);
  }
  return quantisation;
}

ToleratedResults check(const std::vector<Vec3>& environment, const std::vector<Vec3>& model,
                       const std::vector<Pose>& poses, double radius, double tolerance) {
  const Quantisation quantisation = quantisation_of(environment);
  const Query query{model, poses, {.radius = radius}};
  return check_tolerance(quantise(environment, quantisation), quantisation, query, tolerance);
}

/// Places at about the radius from random model points at random poses, out to twice the tolerance
/// and a few ulps to either side of it.
std::vector<Vec3> points_at_radius(Random& random, const std::vector<Vec3>& model,
                                   const std::vector<Pose>& poses, double radius, double tolerance,
                                   std::size_t count) {
  std::vector<Vec3> points;
  while (points.size() < count) {
    const Vec3 m =
        transform(poses[below(random, poses.size())], model[below(random, model.size())]);
    const double side = below(random, 2) == 0 ? -1 : 1;
    double distance = radius + uniform(random, -2, 2) * tolerance;
    if (below(random, 3) == 0) {
      distance = (radius + side * tolerance) * (1 + uniform(random, -4, 4) * 0x1p-52);
    }
    points.push_back(beside(m, random_direction(random), distance));
  }
  return points;
}

ToleratedResults check_at_radius(Random& random, const std::vector<Vec3>& model,
                                 const std::vector<Pose>& poses, double radius, double tolerance,
                                 std::size_t count = 300) {
  return check(points_at_radius(random, model, poses, radius, tolerance, count), model, poses,
               radius, tolerance);
}

}  // namespace

// Everything that is left out lies on one line, as far away as the tolerance allows, and so do the
// points beyond its end: here every part of the tolerance is spent.
TEST_CASE("distances that grow by all of the tolerance") {
  Random random(3);
  std::uint64_t differing = 0;
  for (int trial = 0; trial < 80; ++trial) {
    CAPTURE(trial);
    const double radius = uniform(random, 0.1, 2);
    const double tolerance = radius * uniform(random, 0.01, 0.4);
    const Vec3 along = random_direction(random);
    std::vector<Vec3> model{{0, 0, 0}};
    std::vector<Pose> poses{translation({0, 0, 0})};
    const double step = tolerance * uniform(random, 0.2, 1.05);
    const double move = tolerance * uniform(random, 0.2, 1.05) * (below(random, 2) == 0 ? -1 : 1);
    for (std::uint64_t i = below(random, 3); i-- > 0;) {
      model.push_back(beside(model.back(), along, step));
    }
    for (std::uint64_t i = below(random, 3); i-- > 0;) {
      const double* last = poses.back().translation;
      poses.push_back(translation(beside({last[0], last[1], last[2]}, along, move)));
    }
    std::vector<Vec3> environment;
    for (int i = 0; i < 120; ++i) {
      const Vec3 start = transform(below(random, 2) == 0 ? poses[0] : poses.back(), model.back());
      environment.push_back(beside(start, along, radius + uniform(random, -2, 2) * tolerance));
    }
    differing += check(environment, model, poses, radius, tolerance).differing;
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
    const double step = tolerance * uniform(random, 0.3, 1.02);
    const double move = tolerance * uniform(random, 0.3, 1.02);
    std::vector<Vec3> model{{0, 0, 0}, beside({0, 0, 0}, along, step)};
    const std::vector<Pose> poses{translation({0, 0, 0}),
                                  translation(beside({0, 0, 0}, along, -move))};
    const Vec3 at = beside(model[1], along, radius - uniform(random, 0.4, 1.5) * tolerance);
    for (int i = 0; i < 20; ++i) {
      const double farther = tolerance * uniform(random, 1.02, 1.2);
      model.push_back(beside(at, random_direction(random), radius + farther + 2 * move));
    }
    std::vector<Vec3> environment;
    for (int i = 0; i < 50; ++i) {
      environment.push_back(beside(at, random_direction(random), 0.05 * tolerance));
    }
    differing += check(environment, model, poses, radius, tolerance).differing;
  }
  CHECK(differing > 100);
}

TEST_CASE("a tolerance in scenes of many kinds") {
  Random random(7);
  std::uint64_t differing = 0, colliding = 0;
  for (int trial = 0; trial < 90; ++trial) {
    CAPTURE(trial);
    const double size = std::exp(uniform(random, -2, 3));
    const Box room{{-size, -size, -size}, {size, size, size}};
    const Box part{{-0.2 * size, -0.3 * size, 0}, {0.2 * size, 0.3 * size, 0.1 * size}};
    const double radius = size * std::exp(uniform(random, -4, -1));
    const double tolerance = radius * std::exp(uniform(random, -9, -0.05));
    std::vector<Vec3> model = random_points(random, part, 1 + below(random, 200));
    std::vector<Pose> poses = smooth_path(random, room, 1 + below(random, 120));
    switch (trial % 6) {
      case 0:  // duplicates and stops
        for (Vec3& m : model) m = model[below(random, model.size())];
        for (std::size_t i = 1; i < poses.size(); ++i) {
          if (below(random, 3) > 0) poses[i] = poses[i - 1];
        }
        break;
      case 1:  // jumps
        for (Pose& pose : poses) {
          if (below(random, 4) == 0) pose = random_rotation(random, random_point(random, room));
        }
        break;
      case 2:  // rotation on the spot
        for (std::size_t i = 0; i < poses.size(); ++i) {
          poses[i] = rotation({0, 0, 1}, 1e-3 * static_cast<double>(i), {0.1, 0.2, 0.3});
        }
        break;
      case 3:
        for (Pose& pose : poses) pose = printed_with_six_digits(pose);
        break;
      case 4:
        for (Pose& pose : poses) pose = stretched(pose, {2.5, 0.6, 1.2});
        break;
      default:
        break;
    }
    if (trial % 4 == 1) {
      for (Pose& pose : poses) {
        pose.translation[0] += 5e6;
        pose.translation[1] -= 5e6;
      }
    }
    const ToleratedResults answers = check_at_radius(random, model, poses, radius, tolerance);
    differing += answers.differing;
    colliding += answers.colliding;
  }
  CHECK(colliding > 1000);
  CHECK(differing > 100);
}

TEST_CASE("a tolerance to the last digits") {
  Random random(13);
  const std::vector<Vec3> model{{0, 0, 0}};
  for (const double tolerance : {0.05, 1e-3, 1e-9, 1e-15}) {
    for (int trial = 0; trial < 12; ++trial) {
      const std::vector<Pose> poses{translation({uniform(random, 0, 1e-3), 0, 0})};
      const double radius = uniform(random, 0.06, 1);
      const double side = trial % 2 == 0 ? -1 : 1;
      const Vec3 at = beside(transform(poses[0], model[0]), random_direction(random),
                             radius + side * tolerance);
      const Quantisation quantisation{{0x1p-55, 0x1p-55, 0x1p-55}, {at.x, at.y, at.z}};
      std::vector<Quantum> points;
      for (int i = 0; i < 300; ++i) {
        Quantum q;
        for (auto& along : q) along = static_cast<std::int32_t>(below(random, 65)) - 32;
        points.push_back(q);
      }
      check_tolerance(points, quantisation, {model, poses, {.radius = radius}}, tolerance);
    }
  }
}

TEST_CASE("a tolerance where model and environment are lattices") {
  std::vector<Vec3> model, environment;
  for (int i = 0; i < 12 * 12; ++i) model.push_back({0.125 * (i % 12), 0.125 * (i / 12), 0});
  for (int i = 0; i < 16 * 16 * 8; ++i) {
    environment.push_back(
        {0.125 * (i % 16) - 0.25, 0.125 * (i / 16 % 16) - 0.25, 0.125 * (i / 256)});
  }
  std::vector<Pose> poses;
  for (int i = 0; i < 40; ++i) poses.push_back(translation({0.03125 * i, 0, 0.015625 * i}));
  for (const double tolerance : {0.03125, 0.0625, 0.125, 0.2}) {
    const ToleratedResults answers = check(environment, model, poses, 0.25, tolerance);
    CHECK(answers.colliding > 100);
  }
}

TEST_CASE("a tolerance below every rounding changes nothing") {
  Random random(17);
  for (const double far : {0.0, 5e6}) {
    const std::vector<Vec3> model = random_points(random, {{0, 0, 0}, {1, 1, 1}}, 50);
    std::vector<Pose> poses = smooth_path(random, {{-2, -2, -2}, {2, 2, 2}}, 50);
    for (Pose& pose : poses) pose.translation[0] += far;
    const ToleratedResults answers = check_at_radius(random, model, poses, 0.2, 1e-19);
    CHECK(answers.colliding > 10);
    check_equal(answers.differing, 0);
  }
}

TEST_CASE("a tolerance without poses") {
  check_equal(check({{0, 0, 0}, {1, 1, 1}}, {{0, 0, 0}}, {}, 0.5, 0.1).differing, 0);
}
