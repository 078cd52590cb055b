#include "core/trajectory/resample_trajectory.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/predicate.hpp"
#include "core/trajectory/trajectory_summary.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/scenes.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const Box kBodyToResample{{-2, -1, 0}, {3, 1, 1.5}};
constexpr double kHalfTurn = 3.14159265358979323846;

std::vector<Pose> resampled(const std::vector<Pose>& poses, double max_motion,
                            const Box& model = kBodyToResample) {
  NoProgress progress;
  return resample_trajectory(poses, model, max_motion, progress);
}

/// Checks that all given poses are kept in order, and that no random point of the model moves too
/// far in a step.
void check_resampled(const std::vector<Pose>& poses, const std::vector<Pose>& out,
                     double max_motion) {
  auto at = out.begin();
  bool kept = true;
  for (const Pose& pose : poses) {
    at = std::find(at, out.end(), pose);
    kept &= at != out.end();
    if (kept) ++at;
  }
  CHECK(kept);
  CHECK(at == out.end());
  CHECK(largest_motion(kBodyToResample, out) <= max_motion);
  Random random(5);
  bool bounded = true;
  for (std::size_t i = 1; i < out.size(); ++i) {
    const Vec3 m = random_point(random, kBodyToResample);
    bounded &= length(transform(out[i - 1], m) - transform(out[i], m)) <= max_motion;
  }
  CHECK(bounded);
}

}  // namespace

TEST_CASE("resampling bounds the motion and keeps the poses") {
  Random random(21);
  std::vector<Pose> poses;
  const auto add = [&](std::size_t count, double step, double far, double turn) {
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 d = random_direction(random);
      const double by = static_cast<double>(i) * step;
      poses.push_back(rotation(random_direction(random), uniform(random, 0, turn),
                               {far + by + d.x, far + d.y, d.z}));
    }
  };
  SECTION("a smooth path") { poses = smooth_path(random, {{0, 0, 0}, {50, 50, 5}}, 100); }
  SECTION("wild turns") { add(60, 0.5, 0, kHalfTurn); }
  SECTION("far from the origin") { add(60, 2, 5e6, 0.5); }
  SECTION("printed with six digits") {
    add(60, 1, 1e3, 1);
    print_with_six_digits(poses);
  }
  SECTION("scaled and sheared") {
    add(30, 1, 0, 1);
    for (Pose& pose : poses) pose = stretched(pose, {uniform(random, 0.5, 2), 1, 1});
  }
  SECTION("half turns") {
    for (int i = 0; i < 20; ++i)
      poses.push_back(rotation({0, 0, 1}, i * kHalfTurn, {i * 0.1, 0, 0}));
  }
  SECTION("stops, repeats and jumps") {
    add(5, 1, 0, 1);
    poses.insert(poses.end(), 30, poses.back());
    add(5, 1, 700, 1);
    poses.insert(poses.end(), 30, poses.back());
    poses.push_back(poses[0]);
  }
  SECTION("equal poses far away") { poses.assign(50, rotation({1, 0, 0}, 1, {5e6, 2e6, 1e9})); }
  SECTION("one pose") { add(1, 0, 0, 1); }
  SECTION("two poses") { add(2, 1, 0, 1); }
  SECTION("none") {}
  for (const double max_motion : {0.03, 1.0}) {
    check_resampled(poses, resampled(poses, max_motion), max_motion);
  }
}

TEST_CASE("resampling adds hardly more poses than the way needs") {
  Random random(22);
  const auto poses = smooth_path(random, {{0, 0, 0}, {50, 50, 5}}, 20);
  const auto out = resampled(poses, 0.01);
  const auto finest = resampled(poses, 0.001);
  double length = 0, shortest = 1;
  for (std::size_t i = 1; i < finest.size(); ++i) {
    length += motion_bound(kBodyToResample, finest[i - 1], finest[i]);
  }
  for (std::size_t i = 1; i < out.size(); ++i) {
    shortest = std::min(shortest, motion_bound(kBodyToResample, out[i - 1], out[i]));
  }
  CHECK(static_cast<double>(out.size()) <= 1.05 * length / 0.01 + 40);
  CHECK(shortest >= 0.009);
}

TEST_CASE("resampling is steady in steps on a straight jump between slow poses") {
  std::vector<Pose> poses;
  for (int i = 0; i < 10; ++i) poses.push_back(translation({i * 0.001 + (i < 5 ? 0 : 300), 0, 0}));
  const auto out = resampled(poses, 0.01);
  CHECK(out.size() < 31000);
  check_resampled(poses, out, 0.01);
}

TEST_CASE("what is dense enough already is left alone") {
  Random random(23);
  const auto poses = smooth_path(random, {{0, 0, 0}, {1, 1, 1}}, 1000);
  const double motion = largest_motion(kBodyToResample, poses);
  CHECK(resampled(poses, motion) == poses);
  const auto once = resampled(poses, motion / 3);
  CHECK(once.size() > 2 * poses.size());
  CHECK(resampled(once, motion / 3) == once);
}

TEST_CASE("a model of one point may turn about itself") {
  std::vector<Pose> poses;
  for (int i = 0; i < 40; ++i) {
    poses.push_back(rotation({0, 0, 1}, i, {i / 10 * 1.0, 0, 0}));
  }
  const Vec3 origin{0, 0, 0};
  const auto out = resampled(poses, 0.1, {origin, origin});
  CHECK(largest_motion({origin, origin}, out) <= 0.1);
  CHECK(out.size() < 100);
}

TEST_CASE("resampling refuses what takes too many poses and says what does not") {
  std::vector<Pose> poses;
  for (int i = 0; i < 10; ++i) poses.push_back(translation({i * 0.1, i < 7 ? 0.0 : 5000, 0}));
  NoProgress progress;
  check_refused([&] { return resample_trajectory(poses, kBodyToResample, 0.01, progress, 1000); },
                "poses 6 and 7 ... expected 5.");
  const auto out = resample_trajectory(poses, kBodyToResample, 5.07, progress, 1000);
  CHECK(out.size() <= 1000 + poses.size());
  CHECK_THROWS_AS(resampled(poses, 1e-5), UsageError);
}

TEST_CASE("resampling refuses a bound below the rounding, and motion that is no number") {
  const std::vector<Pose> far{translation({5e6, 0, 0}), translation({5e6 + 1e-6, 0, 0})};
  check_refused([&] { return resampled(far, 1e-9); }, "rounding");
  const std::vector<Pose> endless{translation({1e300, 0, 0}), translation({-1e300, 0, 0})};
  CHECK_THROWS_AS(resampled(endless, 0.1), InputError);
}

TEST_CASE("every dropped pose is near the kept one that stands for it") {
  Random random(31);
  std::vector<Pose> poses;
  SECTION("a smooth path") { poses = smooth_path(random, {{0, 0, 0}, {20, 20, 5}}, 2000); }
  SECTION("far away, printed with six digits") {
    poses = smooth_path(random, {{5e6, 5e6, 0}, {5e6 + 20, 5e6 + 20, 5}}, 2000);
    print_with_six_digits(poses);
  }
  SECTION("wild") {
    for (int i = 0; i < 300; ++i) {
      poses.push_back(random_rotation(random, random_point(random, {{0, 0, 0}, {1, 1, 1}})));
    }
  }
  for (const double max_motion : {0.02, 0.3, 5.0}) {
    const auto kept = thin_trajectory(poses, kBodyToResample, max_motion);
    REQUIRE_FALSE(kept.empty());
    check_equal(kept.front(), 0);
    CHECK(std::is_sorted(kept.begin(), kept.end()));
    bool near = true, needed = true;
    for (std::size_t i = 0, k = 0; i < poses.size(); ++i) {
      const bool is_kept = k + 1 < kept.size() && kept[k + 1] == i;
      if (is_kept) {
        needed &= motion_bound(kBodyToResample, poses[kept[k]], poses[i]) > max_motion;
        ++k;
      }
      for (int n = 0; n < 4; ++n) {
        const Vec3 m = random_point(random, kBodyToResample);
        near &= length(transform(poses[kept[k]], m) - transform(poses[i], m)) <= max_motion;
      }
    }
    CHECK(near);
    CHECK(needed);
  }
}

TEST_CASE("thinning keeps every so-many-th pose of a line, and one of a stop") {
  std::vector<Pose> poses;
  for (int i = 0; i < 100; ++i) poses.push_back(translation({i * 1.0, 0, 0}));
  const auto kept = thin_trajectory(poses, kBodyToResample, 3.5);
  REQUIRE(kept.size() == 25);
  for (std::size_t k = 0; k < kept.size(); ++k) CHECK(kept[k] == 4 * k);
  poses.assign(100, translation({5e6, 5e6, 0}));
  poses.resize(150, translation({5e6 + 1, 5e6, 0}));
  CHECK(thin_trajectory(poses, kBodyToResample, 1e-12) == std::vector<std::size_t>{0, 100});
  CHECK(thin_trajectory({}, kBodyToResample, 1).empty());
  check_equal(thin_trajectory({poses.data(), 1}, kBodyToResample, 1).size(), 1);
}
