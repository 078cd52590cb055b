#include "core/trajectory/follow/follow_path.hpp"

#include <cmath>
#include <numbers>

#include "clearway/error.hpp"
#include "core/trajectory/paths.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A path along a circle around the origin at a height of 5, turned about z beside its direction.
std::vector<Pose> circle(double radius, double step, std::size_t count, double turned = 0) {
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = step * static_cast<double>(i) / radius;
    poses.push_back(headed(angle + std::numbers::pi / 2 + turned,
                           {radius * std::cos(angle), radius * std::sin(angle), 5}));
  }
  return poses;
}

FollowedPath follow(const std::vector<Pose>& poses, const BodyMount& mount) {
  return follow_path(PathStations(poses, 2), mount, 2);
}

std::string codes(const std::vector<Pose>& poses, const BodyMount& mount) {
  const PathStations path(poses, 1);
  return codes_of(doubts_about(follow_path(path, mount, 1), path, mount, "body"));
}

}  // namespace

TEST_CASE("the origin divides the chord as 0 divides the pivots") {
  // From the tightest curves of railways to a wide one; most pivots lie between poses.
  const double radius = GENERATE(80.0, 120.0, 4000.0);
  const auto poses = circle(radius, 0.1, 801);
  const BodyPivots pivots =
      GENERATE(BodyPivots{10.05, -10.05}, BodyPivots{12.03, -4.01}, BodyPivots{3.3, -17.77},
               BodyPivots{12.03, 4.01}, BodyPivots{-6, 6.5});
  const auto body = follow(poses, pivots);
  for (std::size_t k = 0; k < body.of.size(); ++k) {
    const std::size_t i = body.of[k];
    if (i < 210 || i > 590) continue;
    const auto place = [&](double ahead) {
      const double angle = (0.1 * static_cast<double>(i) + ahead) / radius;
      return Vec3{radius * std::cos(angle), radius * std::sin(angle), 5};
    };
    const Vec3 front = place(pivots.front), rear = place(pivots.rear), chord = front - rear;
    const double share = -pivots.rear / (pivots.front - pivots.rear);
    check_near(body.poses[k].position(), rear + share * chord, 1e-9);
    check_near(axis_of(body.poses[k], 0), 1 / length(chord) * chord, 1e-9);
    check_near(axis_of(body.poses[k], 2), {0, 0, 1}, 1e-12);
  }
}

TEST_CASE("a followed frame is a rotation whose up is the mean made perpendicular to the chord") {
  Random random(64);
  std::vector<Pose> poses;
  for (int i = 0; i < 60; ++i) {
    const double s = 0.5 * i;
    Pose pose = rotation({1, 0.1, 0}, 0.4 * std::sin(s / 9), {s, 3 * std::sin(s / 8), 0.2 * s});
    poses.push_back(i % 2 == 0 ? pose : printed_with_six_digits(pose));
  }
  const PathStations path(poses, 1);
  const auto body = follow_path(path, BodyPivots{4.2, -3.1}, 1);
  REQUIRE(body.poses.size() > 20);
  for (std::size_t k = 0; k < body.poses.size(); ++k) {
    const Vec3 x = axis_of(body.poses[k], 0), y = axis_of(body.poses[k], 1),
               z = axis_of(body.poses[k], 2);
    for (const double one : {dot(x, x), dot(y, y), dot(z, z)}) check_near(one, 1, 1e-14);
    for (const double none : {dot(x, y), dot(y, z), dot(z, x)}) check_near(none, 0, 1e-14);
    check_near(cross(x, y), z, 1e-14);
    const std::size_t i = body.of[k];
    Vec3 up{0, 0, 0};
    for (const double ahead : {4.2, -3.1}) {
      const Vec3 one = axis_of(path.pose_at(*path.ahead_of(i, ahead)), 2);
      up = up + 1 / length(one) * one;
    }
    // Up, without its part along the chord, is along z and not along y.
    CHECK(dot(up, z) > 0);
    check_near(dot(up, y), 0, 1e-12);
  }
}

TEST_CASE("a body at a station has the poses of the curve, and at 0 those of the path") {
  auto poses = circle(50, 0.5, 41);
  for (Pose& pose : poses) pose.translation[0] += 5e5;
  CHECK(follow(poses, BodyStation{0}).poses == poses);
  const auto ahead = follow(poses, BodyStation{2.3});
  REQUIRE(ahead.of.size() == 36);
  check_equal(ahead.off_path, {36, 37, 38, 39, 40});
  for (std::size_t k = 4; k < 30; ++k) {
    const double angle = (0.5 * static_cast<double>(ahead.of[k]) + 2.3) / 50;
    check_near(ahead.poses[k].translation[0] - 5e5, 50 * std::cos(angle), 1e-7);
    CHECK(std::abs(axis_of(ahead.poses[k], 0).x + std::sin(angle)) < 1e-7);
  }
  const auto behind = follow(poses, BodyStation{-2});
  check_equal(behind.of.front(), 4);
  for (std::size_t k = 0; k < 30; ++k) {
    check_near(behind.poses[k].translation[1], poses[k].translation[1], 1e-4);
  }
}

TEST_CASE("a path that turns back folds the body, and has no chord where the pivots meet") {
  auto poses = straight_poses(21, 1);
  for (int x = 19; x >= 0; --x) poses.push_back(translation({double(x), 0, 0}));
  const auto body = follow(poses, BodyPivots{4, -4});
  // At the turning point both pivots are at x = 16.
  check_equal(body.undefined, {20});
  check_equal(body.folded, {19, 21});
  // Where the path goes back with the x axis ahead, the body points the other way.
  check_equal(body.turned.front(), 21);
  check_equal(body.turned.back(), 36);
  for (std::size_t k = 0; k < body.of.size(); ++k) {
    CHECK(axis_of(body.poses[k], 0).x == (body.of[k] < 20 ? 1 : -1));
  }
  check_equal(codes(poses, BodyPivots{4, -4}),
              "note body-off-path, body-undefined, body-folded, body-turned");
}

TEST_CASE("a path driven backwards takes its pivots the other way round") {
  const auto backwards = circle(60, 0.1, 601, std::numbers::pi);
  check_equal(codes(backwards, BodyPivots{5, -5}), "note body-off-path, body-turned");
  check_equal(codes(backwards, BodyPivots{-5, 5}), "note body-off-path");
  check_equal(codes(backwards, BodyStation{5}), "note body-off-path, body-turned");
  CHECK(codes(backwards, BodyStation{0}).empty());
  const auto body = follow(backwards, BodyPivots{-5, 5});
  for (std::size_t k = 0; k < body.of.size(); ++k) {
    CHECK(dot(axis_of(body.poses[k], 0), axis_of(backwards[body.of[k]], 0)) > 0.99);
  }
}

TEST_CASE("poses with the axes of a camera count as turned, and poses with x forward do not") {
  std::vector<Pose> camera;
  for (int i = 0; i < 30; ++i) {  // x right, y down, z forward
    camera.push_back({{0, 0, 1, -1, 0, 0, 0, -1, 0}, {double(i), 0.001 * i * i, 0}});
  }
  const auto body = follow(camera, BodyPivots{2, -2});
  check_equal(body.turned.size(), body.of.size());
  // With x forward, z is taken as up even where it points sideways.
  for (Pose& pose : camera) pose = turned_at({1, 0, 0, 0, 0, 1, 0, -1, 0}, pose.position());
  CHECK(follow(camera, BodyPivots{2, -2}).turned.empty());
}

TEST_CASE("a body on two pivots of one pose or of a path that goes straight up has no pose") {
  const std::vector<Pose> one{translation({1, 2, 3})};
  check_equal(follow(one, BodyPivots{1, -1}).off_path.size(), 1);
  CHECK(follow(one, BodyStation{0}).poses == one);
  CHECK(follow({}, BodyPivots{1, -1}).poses.empty());
  std::vector<Pose> up;
  up.reserve(9);
  for (int z = 0; z < 9; ++z) up.push_back(translation({0, 0, double(z)}));
  check_equal(follow(up, BodyPivots{1, -1}).undefined.size(), 7);
}

TEST_CASE("a body on two pivots refuses a path that mirrors, and one at a station takes it") {
  auto poses = straight_poses(5, 1);
  for (Pose& pose : poses) pose.rotation[4] = -1;
  check_refused<InputError>([&] { follow(poses, BodyPivots{1, -1}); }, "mirror");
  check_equal(follow(poses, BodyStation{1}).poses.size(), 4);
}
