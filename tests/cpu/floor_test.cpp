// Queries with a floor: every engine against brute force.
#include <cmath>
#include <limits>

#include "core/geometry/inside.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/engines/brute_force.hpp"
#include "support/engines/engines.hpp"
#include "support/solid_scene.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A path on level ground: turns about the vertical, and a little noise of height and tilt.
std::vector<Pose> level_path(Random& random, double size, std::size_t count, double noise) {
  std::vector<Pose> poses;
  double heading = uniform(random, 0, 6);
  Vec3 at{uniform(random, -size, size), uniform(random, -size, size), 0};
  for (std::size_t i = 0; i < count; ++i) {
    heading += uniform(random, -0.1, 0.1);
    at = plus(at, 2 * size / static_cast<double>(count), {std::cos(heading), std::sin(heading), 0});
    at.z = noise * uniform(random, -1, 1);
    const double half = 0.5 * std::atan2(std::sin(heading), std::cos(heading));
    poses.push_back(rotation(
        {noise * uniform(random, -1, 1), noise * uniform(random, -1, 1), half == 0 ? 1e-9 : 1},
        2 * half, at));
  }
  return poses;
}

/// A height that matters: that of a point near the model at one of the poses, or one ulp beside it,
/// or any height of the model.
double floor_that_matters(Random& random, const std::vector<Vec3>& positions, const Query& query,
                          const Box& part) {
  const double any = uniform(random, part.lo.z - query.radius, part.hi.z + query.radius);
  if (below(random, 4) == 0) return any;
  for (int tries = 0; tries < 200; ++tries) {
    const Vec3& e = positions[below(random, positions.size())];
    const Pose& pose = query.poses[below(random, query.poses.size())];
    const Vec3 x = pulled_back(pose, e);
    const Box near = part.grown(query.radius);
    bool is_near = true;
    for (int k = 0; k < 3; ++k) is_near = is_near && x[k] >= near.lo[k] && x[k] <= near.hi[k];
    if (!is_near) continue;
    constexpr double kFar = std::numeric_limits<double>::infinity();
    const std::uint64_t ulp = below(random, 3);
    return ulp == 0 ? x.z : std::nextafter(x.z, ulp == 1 ? kFar : -kFar);
  }
  return any;
}

struct Counted {
  std::uint64_t scenes_with_hits = 0;
  std::uint64_t scenes_with_less = 0;  ///< in which the floor leaves colliding points out
};

void check_random_floor(std::uint64_t seed, Counted& counted) {
  Random random(seed);
  const double size = std::exp(uniform(random, -2, 3));
  const double side = size * uniform(random, 0.1, 0.4);
  const Box part{{-side, -side / 2, -side / 4}, {side, side / 2, side / 2}};
  const bool is_level = below(random, 2) == 0;
  const std::size_t kind = seed % 3;  // points, a surface, solids
  const Box room{{-size, -size, -size / 4}, {size, size, size / 2}};
  const std::size_t pose_count = 1 + below(random, 25);
  std::vector<Pose> poses =
      is_level ? level_path(random, size, pose_count, below(random, 2) == 0 ? 0 : 0.02)
               : smooth_path(random, room, pose_count);
  if (below(random, 5) == 0) stretch(poses, {uniform(random, 0.5, 2), 1, uniform(random, 0.5, 2)});
  if (below(random, 5) == 0) print_with_six_digits(poses);
  const double radius = size * std::exp(uniform(random, -4, -1));

  Bodies bodies;
  Query query;
  if (kind == 0) {
    query = {random_points(random, part, 1 + below(random, 30)), poses, {radius}};
  } else {
    bodies.add(random_body(random, side / 2, true), kind == 2);
    if (below(random, 2) == 0) bodies.add(random_surface(random, part, 5), false);
    query = bodies.query(poses, radius);
    if (kind == 1) query.model.solid_of.clear();
  }
  std::vector<Vec3> places = random_points(random, room, 30);
  for (std::size_t i = 0; i < 60; ++i) {  // the ground, and what is near the path
    Vec3 p = random_point(random, room);
    p.z = part.lo.z + 0.01 * size * uniform(random, -1, 1);
    places.push_back(p);
    const Pose& pose = poses[below(random, poses.size())];
    places.push_back(transform(pose, random_point(random, part.grown(radius))));
  }
  // Clumps that are small beside the radius, so that blocks are accepted and bounded as a whole.
  for (std::size_t clump = 0; clump < 4; ++clump) {
    const Vec3 middle =
        transform(poses[below(random, poses.size())], random_point(random, part.grown(radius)));
    const double half = radius * uniform(random, 0.05, 0.8);
    for (std::size_t i = 0; i < 64; ++i) {
      places.push_back(
          plus(middle, 1, random_point(random, {{-half, -half, -half}, {half, half, half}})));
    }
  }
  const double scale = size * 1e-6;
  Quantisation quantisation{{scale, scale, 2 * scale}, {0, 0, 0}};
  const auto points = quantise(places, quantisation);
  if (below(random, 3) == 0) {
    const Vec3 offset{5e5, 5e6, 300};
    for (int k = 0; k < 3; ++k) {
      quantisation.offset[k] += offset[k];
      for (Pose& pose : query.poses) pose.translation[k] += offset[k];
    }
  }
  const std::vector<Vec3> positions = positions_of(points, quantisation);
  const std::uint32_t cell_points = std::uint32_t{64} << below(random, 5);
  const MemoryCloudOptions packing{cell_points, static_cast<std::uint32_t>(below(random, 2) * 100)};
  query.floor = floor_that_matters(random, positions, query, part);
  const std::uint64_t hits = check_engines(points, quantisation, query, packing);
  const auto without = [&] {
    Query all = query;
    all.floor.reset();
    std::uint64_t count = 0;
    for (const std::uint32_t pose : brute_force_first_poses(positions, all)) {
      count += pose != kNoPose;
    }
    return count;
  };
  counted.scenes_with_hits += hits > 0;
  counted.scenes_with_less += hits < without();
}

}  // namespace

TEST_CASE("random scenes with a floor") {
#ifdef CLEARWAY_SANITIZED
  constexpr std::uint64_t kScenes = 60;
#else
  constexpr std::uint64_t kScenes = 200;
#endif
  Counted counted;
  for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
    CAPTURE(seed);
    check_random_floor(seed, counted);
  }
  CHECK(counted.scenes_with_hits > kScenes / 2);
  CHECK(counted.scenes_with_less > kScenes / 2);
}

TEST_CASE("a floor and ignored points") {
  Random random(3);
  const Box room{{-4, -3, -1}, {5, 4, 2}}, part{{-0.6, -0.4, -0.3}, {0.7, 0.5, 0.4}};
  const Quantisation quantisation{{1e-4, 1e-4, 1e-4}, {0, 0, 0}};
  const auto points = quantise(random_points(random, room, 2000), quantisation);
  std::vector<std::uint8_t> classes(points.size());
  for (std::uint8_t& value : classes) value = static_cast<std::uint8_t>(below(random, 3));
  Query query{random_points(random, part, 60), smooth_path(random, room, 40), {0.3}};
  query.floor = 0.1;
  query.ignore_classes = {1};
  CHECK(check_engines(points, classes, quantisation, query) > 0);
}

TEST_CASE("a floor above everything, and one below") {
  Random random(4);
  const Box room{{-4, -3, -1}, {5, 4, 2}}, part{{-0.6, -0.4, -0.3}, {0.7, 0.5, 0.4}};
  const Quantisation quantisation{{1e-4, 1e-4, 1e-4}, {0, 0, 0}};
  const auto points = quantise(random_points(random, room, 2000), quantisation);
  Query query{random_points(random, part, 60), smooth_path(random, room, 40), {0.3}};
  const std::uint64_t all = check_engines(points, quantisation, query);
  query.floor = 1e6;
  check_equal(check_engines(points, quantisation, query), 0);
  query.floor = -1e6;
  check_equal(check_engines(points, quantisation, query), all);
}
