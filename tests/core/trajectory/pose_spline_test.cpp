#include "core/trajectory/pose_spline.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "clearway/error.hpp"
#include "core/geometry/predicate.hpp"
#include "core/trajectory/paths.hpp"
#include "core/trajectory/trajectory_summary.hpp"
#include "support/catch.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const Box kBodyOfSpline{{-2, -1, 0}, {3, 1, 1.5}};

struct SplinedPoses {
  explicit SplinedPoses(std::vector<Pose> given)
      : poses(std::move(given)), spline(poses, motions()) {}

  std::vector<double> motions() const {
    std::vector<double> out;
    for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
      out.push_back(motion_bound(kBodyOfSpline, poses[i], poses[i + 1]));
    }
    return out;
  }
  double span(std::size_t i) const { return std::sqrt(motions()[i]); }

  std::vector<Pose> poses;
  PoseSpline spline;
};

/// The largest difference of two rotations' elements.
double rotation_distance(const Pose& a, const Pose& b) {
  double greatest = 0;
  for (int k = 0; k < 9; ++k) {
    greatest = std::max(greatest, std::abs(a.rotation[k] - b.rotation[k]));
  }
  return greatest;
}

/// The pose on a helix at the angle s, tilted by 0.3 about its own x axis.
Pose on_helix(double s) {
  return turned_at(about_z(s) * about_x(0.3), {10 * std::cos(s), 10 * std::sin(s), 2 * s});
}

/// The largest distance of a model point from where it is on the helix at the same height, for
/// `count` poses over two turns.
double helix_error(int count) {
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) poses.push_back(on_helix(4 * std::numbers::pi * i / (count - 1)));
  const SplinedPoses curve(poses);
  double error = 0;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    for (int k = 0; k <= 20; ++k) {
      const Pose pose = curve.spline.between(i).at(k / 20.0);
      error = std::max(error, motion_bound(kBodyOfSpline, pose, on_helix(pose.translation[2] / 2)));
    }
  }
  return error;
}

}  // namespace

TEST_CASE("a pose spline passes through its poses, with rotations that stay orthonormal") {
  Random random(11);
  const double far = GENERATE(0.0, 5e6);
  const bool printed = GENERATE(false, true);
  std::vector<Pose> poses = random_walk(random, 200, far, 3.1);
  if (printed) print_with_six_digits(poses);
  const SplinedPoses curve(poses);
  const double ulp = far == 0 ? 1e-13 : 4e-9;
  bool passes = true;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const PoseCurve way = curve.spline.between(i);
    for (const int end : {0, 1}) {
      passes &= distance(way.at(end), poses[i + static_cast<std::size_t>(end)]) <= ulp;
      passes &= rotation_distance(way.at(end), poses[i + static_cast<std::size_t>(end)]) <= 1e-13;
    }
    for (int k = 0; k <= 10 && !printed; ++k) {
      const Pose between = way.at(k / 10.0);
      const Vec3 x = axis_of(between, 0), y = axis_of(between, 1), z = axis_of(between, 2);
      passes &= length(cross(x, y) - z) < 1e-12 && std::abs(length(x) - 1) < 1e-12 &&
                std::abs(dot(x, y)) < 1e-12 && std::abs(length(y) - 1) < 1e-12;
    }
  }
  CHECK(passes);
}

TEST_CASE("a pose spline's velocities are continuous at its poses") {
  Random random(13);
  std::vector<Pose> poses = random_walk(random, 100, 0, 1.5);
  SECTION("all poses different") {}
  SECTION("a stop") { poses.insert(poses.begin() + 50, 20, poses[50]); }
  SECTION("printed with six digits") { print_with_six_digits(poses); }
  const SplinedPoses curve(poses);
  double worst = 0;
  for (std::size_t before = 0, i = 1; i + 1 < poses.size(); ++i) {
    if (curve.span(i - 1) > 0) before = i - 1;
    if (curve.span(i) == 0) continue;
    // Second-order differences from either side, with a unit of the parameter.
    constexpr double kStep = 1e-5;
    const auto slope = [&](const PoseCurve& way, double at, double by, double span, auto&& value) {
      return (-3 * value(way.at(at)) + 4 * value(way.at(at + by)) - value(way.at(at + 2 * by))) /
             (2 * by * span);
    };
    for (int k = 0; k < 12; ++k) {
      const auto value = [k](const Pose& p) {
        return k < 9 ? p.rotation[k] : p.translation[k - 9];
      };
      const double left = slope(curve.spline.between(before), 1, -kStep, curve.span(before), value);
      const double right = slope(curve.spline.between(i), 0, kStep, curve.span(i), value);
      const double scale = (k < 9 ? 1 : 0.01) / std::min(curve.span(before), curve.span(i));
      worst = std::max(worst, std::abs(left - right) / scale);
    }
  }
  CHECK(worst < 1e-6);
}

TEST_CASE("a pose spline through a helix converges cubically") {
  const double coarse = helix_error(25), middle = helix_error(49), fine = helix_error(97);
  CHECK(coarse < 0.1);
  CHECK(middle < coarse / 6);
  CHECK(fine < middle / 6);
}

TEST_CASE("a pose spline stays near its chords at corners, stops and jumps") {
  std::vector<Pose> poses;
  SECTION("steps of every size") {
    Random random(14);
    poses = random_walk(random, 400, 0, 0);
  }
  SECTION("stop and go around a corner, the stops noisy") {
    Random random(15);
    for (int stop = 0; stop < 10; ++stop) {
      for (int i = 0; i < 20; ++i) {
        poses.push_back(translation(
            {stop * 5 + uniform(random, 0, 1e-4), stop % 2 * 5 + uniform(random, 0, 1e-4), 0}));
      }
    }
  }
  SECTION("a jump of kilometres") {
    for (int i = 0; i < 20; ++i) poses.push_back(translation({i * 0.1, i < 10 ? 0.0 : 5000, 0}));
  }
  SECTION("there and back") {
    for (int i = 0; i < 20; ++i) poses.push_back(translation({i % 2 * 1.0, 0, 0}));
  }
  const SplinedPoses curve(poses);
  double worst = 0;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const double length = distance(poses[i], poses[i + 1]);
    for (int k = 1; k < 20; ++k) {
      const Pose pose = curve.spline.between(i).at(k / 20.0);
      const double detour = distance(poses[i], pose) + distance(pose, poses[i + 1]) - length;
      worst = std::max(worst, detour / length);
    }
  }
  CHECK(worst <= 0.15);
}

TEST_CASE("a turn on the spot stays on the spot, and a straight way beside it straight") {
  const double noise = GENERATE(0.0, 1e-6);
  Random random(16);
  std::vector<Pose> poses;
  const auto add = [&](double angle, double x, double y) {
    poses.push_back(rotation({0, 0, 1}, angle + uniform(random, 0, noise),
                             {x + uniform(random, 0, noise), y + uniform(random, 0, noise), 0}));
  };
  for (int i = 0; i < 5; ++i) add(0, i, 0);
  for (int i = 1; i < 5; ++i) add(0.4 * i, 4, 0);
  for (int i = 1; i < 5; ++i) add(1.6, 4, i);
  const SplinedPoses curve(poses);
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const Pose middle = curve.spline.between(i).at(0.5);
    if (i >= 4 && i < 8) {
      CHECK(distance(middle, poses[4]) <= 4 * noise + 1e-15);
    } else {
      CHECK(rotation_distance(middle, poses[i]) <= 4 * noise + 1e-15);
    }
  }
}

TEST_CASE("two poses are joined by a straight line and one even turn") {
  const double angle = GENERATE(0.0, 1e-9, 1.0, 3.0, std::numbers::pi);
  const Vec3 axis{0, 0.6, 0.8};
  const SplinedPoses curve({translation({1, 2, 3}), rotation(axis, angle, {3, 2, 3})});
  for (const double t : {0.25, 0.5, 0.75}) {
    const Pose pose = curve.spline.between(0).at(t);
    CHECK(distance(pose, translation({1 + 2 * t, 2, 3})) <= 1e-14);
    const bool either_way = angle == std::numbers::pi;
    const double forth = rotation_distance(pose, rotation(axis, t * angle, {}));
    const double back = rotation_distance(pose, rotation(axis, -t * angle, {}));
    CHECK((either_way ? std::min(forth, back) : forth) <= 1e-14);
  }
}

TEST_CASE("stretches are interpolated beside rotations, mirrored poses among themselves") {
  const double sign = GENERATE(1.0, -1.0);
  const SplinedPoses curve({stretched(translation({0, 0, 0}), {sign, 1, 1}),
                            stretched(rotation({0, 0, 1}, 1, {5, 0, 0}), {3 * sign, 1, 1})});
  const Pose middle = curve.spline.between(0).at(0.5);
  const Pose expected = stretched(rotation({0, 0, 1}, 0.5, {2.5, 0, 0}), {2 * sign, 1, 1});
  CHECK(rotation_distance(middle, expected) < 1e-14);
  CHECK(distance(middle, expected) < 1e-14);
}
