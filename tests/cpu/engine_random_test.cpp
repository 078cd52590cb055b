// Every engine against brute force on several hundred small random scenes.
#include <cmath>

#include "support/catch.hpp"
#include "support/engines/engines.hpp"
#include "support/scenes.hpp"

using namespace clearway;

namespace {

Box random_box(Random& random, double largest) {
  Box box{};
  for (int k = 0; k < 3; ++k) {
    box.lo[k] = -uniform(random, 0, largest);
    box.hi[k] = below(random, 5) == 0 ? box.lo[k] : uniform(random, 0, largest);
  }
  return box;
}

std::vector<Vec3> random_cloud(Random& random, const Box& box, std::size_t count) {
  std::vector<Vec3> points = random_points(random, box, count);
  switch (below(random, 4)) {
    case 0:  // clusters
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3& centre = points[i % 7 % points.size()];
        for (int k = 0; k < 3; ++k) points[i][k] += 0.9 * (centre[k] - points[i][k]);
      }
      break;
    case 1:  // duplicates
      for (Vec3& p : points) p = points[below(random, points.size())];
      break;
    default:
      break;
  }
  return points;
}

std::vector<Pose> random_path(Random& random, const Box& box, std::size_t count) {
  std::vector<Pose> poses = smooth_path(random, box, count);
  const std::uint64_t kind = below(random, 6);
  for (Pose& pose : poses) {
    if (kind == 0) pose = random_rotation(random, random_point(random, box));
    if (kind == 1 && below(random, 4) == 0) pose = poses[below(random, poses.size())];
    if (kind == 2) pose = printed_with_six_digits(pose);
    if (kind == 3) pose = stretched(pose, {uniform(random, 0.2, 3), uniform(random, 0.2, 3), 1});
    if (kind == 4) pose = rotation({0, 1, 0}, uniform(random, 0, 6), {0.1, 0.2, 0.3});
  }
  return poses;
}

std::uint64_t check_random_scene(std::uint64_t seed) {
  Random random(seed);
  const double size = std::exp(uniform(random, -3, 4));
  const Box room = random_box(random, size);
  const Box part = random_box(random, size * uniform(random, 0.01, 0.5));
  const auto points = random_cloud(random, room, 1 + below(random, 1500));
  const auto model = random_cloud(random, part, 1 + below(random, 80));
  const std::size_t most = 2'000'000 / (points.size() * model.size());
  auto poses = random_path(random, room, 1 + below(random, std::clamp<std::size_t>(most, 1, 90)));

  const double scale = size * 1e-6;
  Quantisation quantisation{{scale, scale, 2 * scale}, {0, 0, 0}};
  const auto quanta = quantise(points, quantisation);
  if (below(random, 3) == 0) {
    const Vec3 offset{uniform(random, -5e6, 5e6), uniform(random, -5e6, 5e6), 1e3};
    for (int k = 0; k < 3; ++k) {
      quantisation.offset[k] += offset[k];
      for (Pose& pose : poses) pose.translation[k] += offset[k];
    }
  }
  const double radius = size * std::exp(uniform(random, -5, 0));
  const std::uint32_t cell_points = std::uint32_t{64} << below(random, 6);
  return check_engines(quanta, quantisation, {model, poses, {radius}},
                       {cell_points, below(random, 2) * 300});
}

}  // namespace

TEST_CASE("random scenes") {
#ifdef CLEARWAY_SANITIZED
  constexpr std::uint64_t kScenes = 100;  // with sanitizers each takes tens of times as long
#else
  constexpr std::uint64_t kScenes = 200;
#endif
  std::uint64_t with_hits = 0;
  for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
    CAPTURE(seed);
    with_hits += check_random_scene(seed) > 0;
  }
  CHECK(with_hits > kScenes / 4);
}
