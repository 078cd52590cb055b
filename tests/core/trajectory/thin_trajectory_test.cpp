#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "core/geometry/predicate.hpp"
#include "core/trajectory/resample_trajectory.hpp"
#include "core/trajectory/trajectory_summary.hpp"
#include "support/scenes.hpp"

using namespace clearway;

namespace {

const Box kBodyToThin{{-2, -1, 0}, {3, 1, 1.5}};

}  // namespace

TEST_CASE("every dropped pose is near the kept one that stands for it") {
  Random random(31);
  std::vector<Pose> poses;
  SECTION("a smooth path") { poses = smooth_path(random, {{0, 0, 0}, {20, 20, 5}}, 2000); }
  SECTION("far away, printed with six digits") {
    poses = smooth_path(random, {{5e6, 5e6, 0}, {5e6 + 20, 5e6 + 20, 5}}, 2000);
    std::transform(poses.begin(), poses.end(), poses.begin(), printed_with_six_digits);
  }
  SECTION("wild") {
    for (int i = 0; i < 300; ++i) {
      poses.push_back(random_rotation(random, random_point(random, {{0, 0, 0}, {1, 1, 1}})));
    }
  }
  for (const double max_motion : {0.02, 0.3, 5.0}) {
    const auto kept = thin_trajectory(poses, kBodyToThin, max_motion);
    REQUIRE_FALSE(kept.empty());
    CHECK(kept.front() == 0);
    CHECK(std::is_sorted(kept.begin(), kept.end()));
    bool near = true, needed = true;
    for (std::size_t i = 0, k = 0; i < poses.size(); ++i) {
      const bool is_kept = k + 1 < kept.size() && kept[k + 1] == i;
      if (is_kept) {
        needed &= motion_bound(kBodyToThin, poses[kept[k]], poses[i]) > max_motion;
        ++k;
      }
      for (int n = 0; n < 4; ++n) {
        const Vec3 m = random_point(random, kBodyToThin);
        const double d2 = squared_distance(transform(poses[kept[k]], m), transform(poses[i], m));
        near &= std::sqrt(d2) <= max_motion;
      }
    }
    CHECK(near);
    CHECK(needed);
  }
}

TEST_CASE("thinning a straight line keeps every so-many-th pose") {
  std::vector<Pose> poses;
  for (int i = 0; i < 100; ++i) poses.push_back(translation({i * 1.0, 0, 0}));
  const auto kept = thin_trajectory(poses, kBodyToThin, 3.5);
  REQUIRE(kept.size() == 25);
  for (std::size_t k = 0; k < kept.size(); ++k) CHECK(kept[k] == 4 * k);
}

TEST_CASE("thinning collapses stops, even far from the origin") {
  std::vector<Pose> poses(100, translation({5e6, 5e6, 0}));
  poses.resize(150, translation({5e6 + 1, 5e6, 0}));
  CHECK(thin_trajectory(poses, kBodyToThin, 1e-12) == std::vector<std::size_t>{0, 100});
}

TEST_CASE("thinning few poses") {
  CHECK(thin_trajectory({}, kBodyToThin, 1).empty());
  CHECK(thin_trajectory(std::vector<Pose>{translation({1, 2, 3})}, kBodyToThin, 1).size() == 1);
}
