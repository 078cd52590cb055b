#include "core/trajectory/follow/path_stations.hpp"

#include <cmath>

#include "clearway/error.hpp"
#include "core/trajectory/follow/arc_length.hpp"
#include "core/trajectory/paths.hpp"
#include "core/trajectory/pose_spline.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::vector<double> distances_of(const std::vector<Pose>& poses) {
  std::vector<double> out;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i)
    out.push_back(distance(poses[i], poses[i + 1]));
  return out;
}

/// A random walk on a map with stops and turns on the spot.
std::vector<Pose> random_path(Random& random, std::size_t count) {
  std::vector<Pose> poses = random_walk(random, count, 5e5, 3.1);
  for (std::size_t i = 4; i < count; i += 7) {
    std::copy_n(poses[i - 1].translation, 3, poses[i].translation);
    if (i % 2 == 0) poses[i] = poses[i - 1];
  }
  return poses;
}
/// The length of the curve of resampling by a fine polyline.
double polyline(const PoseSpline& spline, std::size_t way, double to, int pieces) {
  const PoseCurve curve = spline.between(way);
  const PositionCurve positions = spline.positions(way);
  double length = 0;
  // The velocities at the middles are summed, because differences of positions so far from the
  // origin would round.
  for (int k = 0; k < pieces; ++k) {
    length += positions.velocity(to * (k + 0.5) / pieces).norm() * to / pieces;
  }
  // The velocities agree with the curve's positions.
  const double by_positions = distance(curve.at(0.4999), curve.at(0.5001));
  CHECK(positions.velocity(0.5).norm() * 2e-4 == Approx(by_positions).epsilon(1e-4).margin(4e-9));
  return length;
}

}  // namespace

TEST_CASE("arc length is the length of the curve of resampling") {
  Random random(61);
  const auto poses = random_path(random, 40);
  const auto motions = distances_of(poses);
  const PoseSpline spline(poses, motions);
  const PathStations stations(poses, 2);
  double sum = 0;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    CHECK(stations.of_pose(i) == Approx(sum).epsilon(1e-13).margin(1e-12));
    const double length = arc_length(spline.positions(i), 0, 1);
    CHECK(length == Approx(polyline(spline, i, 1, 20000)).epsilon(1e-6).margin(1e-12));
    CHECK(length >= motions[i] - 1e-9);
    sum += length;
  }
  CHECK(stations.length() == Approx(sum).epsilon(1e-13));
}

TEST_CASE("arc length may be cut anywhere, and its parameter is found to a tenth of a nanometre") {
  Random random(63);
  const auto poses = random_path(random, 60);
  const PoseSpline spline(poses, distances_of(poses));
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const PositionCurve curve = spline.positions(i);
    const double whole = arc_length(curve, 0, 1), cut = uniform(random, 0, 1);
    check_near(arc_length(curve, 0, cut) + arc_length(curve, cut, 1), whole, 1e-11);
    for (const double share : {1e-9, 0.1, 0.5, 0.77, 1 - 1e-9}) {
      const double t = parameter_at(curve, share * whole, whole);
      check_near(arc_length(curve, 0, t), share * whole, 1e-10);
    }
    check_equal(parameter_at(curve, 0, whole), 0);
    CHECK(parameter_at(curve, whole, whole) == (whole > 0 ? 1 : 0));
  }
}

TEST_CASE("arc length runs through the place where a path turns back") {
  std::vector<Pose> poses;
  for (const double x : {0.0, 1.0, 2.0, 3.0, 2.0, 1.0, 0.0})
    poses.push_back(translation({x, 0, 0}));
  const PathStations stations(poses, 1);
  // Straight ways stay straight and do not overshoot.
  CHECK(stations.length() == Approx(6).epsilon(1e-12));
  for (std::size_t i = 0; i < poses.size(); ++i) CHECK(stations.of_pose(i) == Approx(double(i)));
  const auto there = stations.ahead_of(0, 2.5), back = stations.ahead_of(6, -2.5);
  REQUIRE(there);
  REQUIRE(back);
  CHECK(stations.pose_at(*there).translation[0] == Approx(2.5).epsilon(1e-12));
  CHECK(stations.pose_at(*back).translation[0] == Approx(2.5).epsilon(1e-12));
  CHECK(stations.direction_at(*there).x > 0);
  CHECK(stations.direction_at(*back).x < 0);
}

TEST_CASE("stations stand still at a stop and take the last of its poses") {
  const std::vector<Pose> poses{translation({0, 0, 0}), translation({2, 0, 0}),
                                rotation({0, 0, 1}, 0.5, {2, 0, 0}),
                                rotation({0, 0, 1}, 1.0, {2, 0, 0}), translation({5, 0, 0})};
  const PathStations stations(poses, 1);
  CHECK(stations.of_pose(1) == stations.of_pose(3));
  const auto place = stations.ahead_of(0, 2);
  REQUIRE(place);
  CHECK(stations.pose_at(*place) == poses[3]);
  CHECK(stations.pose_at(*stations.ahead_of(2, 0)) == poses[2]);
  CHECK(stations.direction_at(*stations.ahead_of(2, 0)).x > 0);
  CHECK(stations.pose_at(*stations.ahead_of(0, 5)) == poses[4]);
  CHECK(stations.direction_at(*stations.ahead_of(4, 0)).x > 0);
}

TEST_CASE("stations off the path have no place but rounding is not off") {
  const std::vector<Pose> poses{translation({0, 0, 0}), translation({3, 4, 0})};
  const PathStations stations(poses, 1), one({poses.data(), 1}, 1);
  CHECK_FALSE(stations.ahead_of(0, -1e-6));
  CHECK_FALSE(stations.ahead_of(1, 1e-6));
  CHECK_FALSE(one.ahead_of(0, 0.1));
  CHECK(stations.pose_at(stations.ahead_of(0, -1e-12).value()) == poses[0]);
  CHECK(stations.pose_at(stations.ahead_of(1, 1e-12).value()) == poses[1]);
  CHECK(one.pose_at(one.ahead_of(0, 0).value()) == poses[0]);
  check_equal(one.direction_at(*one.ahead_of(0, 0)).x, 0);
  check_equal(one.length(), 0);
  check_equal(PathStations({}, 1).length(), 0);
}

TEST_CASE("stations refuse positions without distance") {
  const std::vector<Pose> far{translation({-1e200, 0, 0}), translation({1e200, 0, 0})};
  check_refused([&] { return PathStations(far, 1); }, "poses 0 and 1");
}
