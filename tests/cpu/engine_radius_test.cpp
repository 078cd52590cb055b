// Every engine against brute force where rounding decides: points at the radius and a few units in
// the last place to either side, near the origin and far from it.
#include <cmath>

#include "core/geometry/predicate.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/engines/engines.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("a point exactly at the radius and one unit to either side") {
  const Quantisation quantisation{{0x1p-20, 0x1p-20, 0x1p-20}, {0, 0, 0}};
  const std::int32_t half = 1 << 19;
  const std::vector<Quantum> points{{half, 0, 0}, {0, -half, 0}, {0, 0, half}};
  const std::vector<Vec3> model{{0, 0, 0}};
  const std::vector<Pose> poses{translation({0, 0, 0})};
  check_equal(check_engines(points, quantisation, {model, poses, {0.5}}), 0);
  check_equal(check_engines(points, quantisation, {model, poses, {std::nextafter(0.5, 1)}}), 3);
  check_equal(check_engines(points, quantisation, {model, poses, {std::nextafter(0.5, 0)}}), 0);

  for (const double sign : {-1.0, 1.0}) {
    const std::vector<Pose> nudged{translation({sign * 0x1p-54, 0, 0})};
    check_engines(points, quantisation, {model, nudged, {0.5}});
  }
}

TEST_CASE("whole nodes exactly at the radius") {
  const Quantisation quantisation{{0.5, 0.5, 0.5}, {0, 0, 0}};
  const std::vector<Quantum> points(500, Quantum{6, 8, 0});  // 5 m from the origin
  const std::vector<Vec3> model{{0, 0, 0}};
  const std::vector<Pose> poses{translation({0, 0, 0})};
  check_equal(check_engines(points, quantisation, {model, poses, {5.0}}), 0);
  check_equal(check_engines(points, quantisation, {model, poses, {std::nextafter(5.0, 6)}}), 500);
}

namespace {

struct Boundary {
  Vec3 offset;
  double jitter;  ///< metres; about as large as the rounding of the coordinates
  Vec3 stretch;
  std::size_t model_points;
  std::size_t poses;
  double length = 3;  ///< length of the model, metres
};

/// Checks model points on a line, at poses that hardly move, with environment points beyond the
/// line's end at the radius, give or take `jitter`: as far from every sphere's centre as a
/// collision can be.
std::uint64_t check_boundary(Random& random, const Boundary& boundary, std::uint64_t& total) {
  const double radius = uniform(random, 0.05, 2);
  const Vec3 along = random_direction(random);
  std::vector<Vec3> model;
  for (std::size_t i = 0; i < boundary.model_points; ++i) {
    const double t = boundary.length * (i == 0 ? 1.0 : uniform(random, 0, 1));
    model.push_back({along.x * t, along.y * t, along.z * t});
  }
  const Pose base = stretched(random_rotation(random, boundary.offset), boundary.stretch);
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < boundary.poses; ++i) {
    Pose pose = base;
    for (double& p : pose.translation) p += uniform(random, -1, 1) * boundary.jitter;
    poses.push_back(pose);
  }
  const Pose& last = poses.back();
  const Vec3 end = transform(last, model[0]);
  const Vec3 start = transform(last, {0, 0, 0});
  const Vec3 reach{end.x - start.x, end.y - start.y, end.z - start.z};
  const double length = std::sqrt(squared_length(reach.x, reach.y, reach.z));

  Quantisation quantisation{};
  for (int k = 0; k < 3; ++k) {
    quantisation.scale[k] = boundary.jitter / 64;
    quantisation.offset[k] = end[k] + reach[k] / length * radius;
  }
  std::vector<Quantum> points;
  for (int i = 0; i < 200; ++i) {
    Quantum q;
    for (int k = 0; k < 3; ++k) q[k] = static_cast<std::int32_t>(below(random, 129)) - 64;
    points.push_back(q);
  }
  total += points.size();
  return check_engines(points, quantisation, {model, poses, {radius}}, {128, 0});
}

void check_boundaries(const Boundary& boundary) {
  Random random(11);
  std::uint64_t total = 0, colliding = 0;
  for (int i = 0; i < 10; ++i) colliding += check_boundary(random, boundary, total);
  // Both answers occur many times.
  CHECK(colliding > total / 20);
  CHECK(colliding < total - total / 20);
}

}  // namespace

TEST_CASE("points at the radius, rounding apart") {
  const auto model_points = GENERATE(as<std::size_t>(), 1, 2, 40);
  const auto poses = GENERATE(as<std::size_t>(), 1, 2, 30);
  CAPTURE(model_points, poses);
  SECTION("near the origin") {
    check_boundaries({{0, 0, 0}, 1e-15, {1, 1, 1}, model_points, poses});
  }
  SECTION("a model small beside the radius") {
    check_boundaries({{0, 0, 0}, 4e-16, {1, 1, 1}, model_points, poses, 1e-9});
  }
  SECTION("far from it") {
    check_boundaries({{5e6, 2e6, 1e3}, 2e-9, {1, 1, 1}, model_points, poses});
  }
  SECTION("very far from it") {
    check_boundaries({{-3e12, 7e12, 1e9}, 1e-3, {1, 1, 1}, model_points, poses});
  }
  SECTION("slightly not rigid") {
    check_boundaries({{100, 200, 30}, 1e-13, {1.00009, 1.00008, 1.00009}, model_points, poses});
  }
  SECTION("strongly not rigid") {
    check_boundaries({{1e5, 2e5, 30}, 3e-11, {2.5, 0.4, 1.3}, model_points, poses});
  }
}

TEST_CASE("random pairs whose distance straddles the radius") {
  Random random(5);
  for (int trial = 0; trial < 20; ++trial) {
    const double far = trial % 2 == 0 ? 1 : 1e6;
    const Pose pose = random_rotation(random, {far, -2 * far, 0.5 * far});
    const std::vector<Vec3> model = random_points(random, {{-1, -1, -1}, {1, 1, 1}}, 12);
    const std::vector<Pose> poses{pose};
    const Quantisation quantisation{{0x1p-31, 0x1p-31, 0x1p-31}, {far, -2 * far, 0.5 * far}};
    std::vector<Vec3> near;
    for (int i = 0; i < 100; ++i) near.push_back(transform(pose, model[below(random, 12)]));
    std::vector<Quantum> points;
    for (Vec3 p : near) {
      const Vec3 d = random_direction(random);
      for (int k = 0; k < 3; ++k)
        p[k] = std::clamp(p[k] + 0.3 * d[k], quantisation.offset[k] - 0.99,
                          quantisation.offset[k] + 0.99);
      points.push_back(quantise(std::vector{p}, quantisation)[0]);
    }
    // The radius is the distance of one of the pairs, to the unit in the last place.
    const Vec3 e = positions_of(points, quantisation)[below(random, 100)];
    double least = 1e300;
    for (const Vec3& m : model) least = std::min(least, squared_distance(e, transform(pose, m)));
    double radius = std::sqrt(least);
    for (int step = 0; step < 3; ++step) radius = std::nextafter(radius, 0);
    for (int step = 0; step < 7; ++step) {
      check_engines(points, quantisation, {model, poses, {radius}}, {64, 0});
      radius = std::nextafter(radius, 10);
    }
  }
}
