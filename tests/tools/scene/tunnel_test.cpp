#include <cmath>
#include <set>
#include <tuple>

#include "scene/vector.hpp"
#include "support/catch.hpp"
#include "tools/scene/made_scene.hpp"

using namespace clearway;
using namespace clearway::scene;

namespace {

/// The distance of a point from the track's centreline, near arc length `around`.
double offset_from_track(const Path& path, const Vec3& p, double around) {
  double least = 1e30;
  for (double s = around - 15; s < around + 15; s += 0.05) {
    const Vec3 a = path.to_world({s, 0, 0}), d = path.to_world({s + 0.05, 0, 0}) - a;
    const double f = std::clamp(dot(p - a, d) / dot(d, d), 0.0, 1.0);
    least = std::min(least, length(p - (a + f * d)));
  }
  return least;
}

}  // namespace

TEST_CASE("the tunnel leaves nearly all of its bounding box empty") {
  const auto points = test::made_scene(Kind::kTunnel, {300000, 1, 1}).environment;
  Vec3 low = points[0], high = points[0];
  std::set<std::tuple<int, int, int>> occupied;
  for (const Vec3& p : points) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
    occupied.insert({std::floor(p.x / 4), std::floor(p.y / 4), std::floor(p.z / 4)});
  }
  const Vec3 size = high - low;
  CHECK(length(size) > 1000);
  const double cells = size.x * size.y * size.z / 64;
  CHECK(static_cast<double>(occupied.size()) < 0.03 * cells);
}

TEST_CASE("the open ends are sparser than the tunnel") {
  const auto tunnel = make_scene(Kind::kTunnel, {200000, 1, 1}, 1);
  const double begin = tunnel->world.rooms()[1].begin_s, end = tunnel->world.rooms()[2].begin_s;
  const double x_begin = tunnel->path.at(begin).position.x;
  double before = 0, all = 0, spread = 0;
  for (const Vec3& p : test::las_positions(test::environment_bytes(*tunnel, 1, 2))) {
    all += 1;
    if (p.x >= x_begin) continue;
    before += 1;
    spread = std::max(spread, std::abs(p.y));
  }
  const double open_rate = before / begin, tunnel_rate = (all - 2 * before) / (end - begin);
  CHECK(before > 1000);
  CHECK(open_rate < 0.7 * tunnel_rate);
  CHECK(spread > 15);
}

TEST_CASE("the wagon's bogies lie on the track and its middle swings inwards") {
  const Sizes sizes{1, 1, 300};
  const auto tunnel = make_scene(Kind::kTunnel, sizes, 1);
  const auto poses = test::text_poses(test::trajectory_bytes(*tunnel));
  double swing = 0, swing_of_end = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double around = 14 + (tunnel->path.length() - 28) * static_cast<double>(i) / 299;
    for (const double x : {-kBogieDistance / 2, kBogieDistance / 2}) {
      const double s = around + x;
      CHECK(offset_from_track(tunnel->path, transform(poses[i], {x, 0, 0}), s) < 1e-4);
    }
    swing =
        std::max(swing, offset_from_track(tunnel->path, transform(poses[i], {0, 0, 0}), around));
    swing_of_end =
        std::max(swing_of_end,
                 offset_from_track(tunnel->path, transform(poses[i], {12.5, 0, 0}), around + 12.5));
  }
  CHECK(swing == Approx(20.0 * 20 / (8 * 320)).epsilon(0.02));
  CHECK(swing_of_end > 0.05);
}

TEST_CASE("the wagon has a wagon's size") {
  const auto model = test::made_scene(Kind::kTunnel, {1, 28622, 1}).model;
  double longest = 0, widest = 0, highest = 0, lowest = 1e30;
  for (const Vec3& p : model) {
    longest = std::max(longest, std::abs(p.x));
    widest = std::max(widest, std::abs(p.y));
    highest = std::max(highest, p.z);
    lowest = std::min(lowest, p.z);
  }
  CHECK(longest == Approx(12.5).margin(0.05));
  CHECK(widest == Approx(1.6).margin(0.05));
  CHECK(highest == Approx(3.9).margin(0.05));
  CHECK(lowest == Approx(0).margin(0.03));
}
