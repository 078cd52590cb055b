// Conflicts of real searches: their poses, stations, sides and shifts, against brute force.
#include <cmath>

#include "clearway/clearway.hpp"
#include "core/query/search_result.hpp"
#include "core/trajectory/paths.hpp"
#include "findings/searched_scene.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("a conflict's poses are those of its points, and hold the one of its least distance") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const Box room{{0, -3, 0}, {12, 3, 2}};
    std::vector<Vec3> model = random_points(random, {{-0.6, -0.4, 0}, {0.6, 0.4, 0.8}}, 60);
    Query query(std::move(model), smooth_path(random, room, 60),
                {.radius = 0.15, .clearance = 0.3});
    const SearchedScene scene(random_points(random, room, 3000), query);
    std::vector<std::uint32_t> conflict_of;
    const Conflicts found = scene.conflicts({.gap = 0.3, .min_points = 1}, &conflict_of);
    REQUIRE(found.listed.size() > 1);
    const Result result = scene.result();
    const auto first = result.first_pose(), last = result.last_pose();
    for (const Conflict& conflict : found.listed) {
      REQUIRE(conflict.nearest_pose);
      CHECK(conflict.first_pose <= *conflict.nearest_pose);
      CHECK(*conflict.nearest_pose <= conflict.last_pose);
      std::uint32_t from = kNoPose, to = 0;
      for (std::size_t row = 0; row < first.size(); ++row) {
        if (conflict_of[row] != conflict.id) continue;
        from = std::min(from, first[row]);
        to = std::max(to, last[row]);
      }
      CHECK(conflict.first_pose == from);
      CHECK(conflict.last_pose == to);
    }
  }
}

TEST_CASE("a pole that a long load meets in its middle is named with station, side and shift") {
  // The load swings: at 20 m the path turns to the left, and its middle cuts the corner.
  const std::vector<Pose> poses = circle_poses(1 / 50.0, 0.5, 81);
  // 1.4 m to the left of the middle of the load, whose side is at 1.5 m, so 0.1 m inside it
  const Vec3 at = poses[40].position() + poses[40].rotated({0, 1.4, 0});
  std::vector<Vec3> pole;
  for (int i = 0; i < 40; ++i) pole.push_back({at.x, at.y, 0.05 * i});
  for (const bool solid : {true, false}) {
    CAPTURE(solid);
    Query query = solid_box({{-15, -1.5, 0.2}, {15, 1.5, 3}}, poses, 0.1);
    if (!solid) query.model.solid_of.clear();
    query.clearance = 0.2;
    const Conflict c = SearchedScene(pole, query).only_conflict();
    CHECK(c.side == Side::kLeft);
    // The pole stands beside the pose in the middle of the path, at 0.4 rad of 50 m.
    CHECK(c.obstacle_chainage.value() == Approx(20).margin(0.5));
    check_near(c.own_shift_right.value(), 0.2, 1e-3);
    CHECK_FALSE(c.own_shift_left);  // 3 m more than there is
    CHECK(c.chainage_to > c.chainage_from + 5);
  }
}

TEST_CASE("what the front of a vehicle meets is in front, whatever it is made of") {
  std::vector<Vec3> wall;
  for (int i = 0; i < 40; ++i) {
    for (int k = 0; k < 20; ++k) wall.push_back({12.1, -0.9 + 0.045 * i, 0.3 + 0.06 * k});
  }
  for (const bool solid : {true, false}) {
    Query query = solid_box({{-2, -1, 0}, {2, 1, 1.5}}, straight_path(20), 0.1);
    if (!solid) query.model.solid_of.clear();
    query.clearance = 0.2;
    const Conflict c = SearchedScene(wall, query).only_conflict();
    CHECK(c.first_touch == Side::kFront);
    CHECK(*c.obstacle_chainage == Approx(12.1).margin(1e-9));
    // The conflict reaches from the pose at 10 m, whose front is at 12 m, to where the rear at -2 m
    // has passed.
    check_equal(c.chainage_from, 10);
    check_equal(c.chainage_to, 14);
  }
}

TEST_CASE("between poses the range ends with the pose after the last way that touches") {
  const Query query({{0, 0, 0.5}}, straight_path(10), {.radius = 0.1, .between_poses = true});
  const Conflict c = SearchedScene({{4.25, 0.05, 0.5}}, query).only_conflict();
  check_equal(c.first_pose, 8);
  check_equal(c.last_pose, 8);
  check_equal(c.chainage_from, 4);
  check_equal(c.chainage_to, 4.5);
  CHECK(*c.obstacle_chainage == Approx(4.25));
}

TEST_CASE("groups that are too small to be listed are told one by one") {
  const Query query({{0, 0, 0.5}}, straight_path(10), {.radius = 0.1});
  const SearchedScene scene({{4, 0, 0.5}, {4, 0.05, 0.5}, {8, 0, 0.5}}, query);
  const Conflicts found = scene.conflicts({.min_points = 10});
  CHECK(found.listed.empty());
  REQUIRE(found.small.size() == 2);
  check_equal(found.small_points, 3);
  check_equal(found.small[0].points, 2);
  check_equal(found.small[0].chainage_from, 4);
  check_equal(found.small[1].source, 2);
  check_equal(found.small[1].chainage_from, 8);
}

TEST_CASE("shifts free the ways between poses too, and are to the left of what is ahead") {
  std::vector<Pose> to_y;
  for (int i = 0; i <= 20; ++i) to_y.push_back(translation({0, 0.05 * i, 0}));
  const Conflict between =
      SearchedScene({{5, 0.05, 0}}, Query({{0, 0, 0}}, straight_path(10, 10),
                                          {.radius = 0.1, .between_poses = true}))
          .only_conflict();
  const Conflict across = SearchedScene({{0.05, 0.5, 0}}, Query({{0, 0, 0}}, to_y, {.radius = 0.1}))
                              .only_conflict({.min_points = 1, .forward = Axis::kPlusY});
  CHECK(between.own_shift_left.value() == Approx(0.15).margin(1e-6));
  CHECK(between.own_shift_right.value() == Approx(0.05).margin(1e-6));
  CHECK(across.lateral.value() == Approx(-0.05));  // to the right
  CHECK(across.own_shift_left.value() == Approx(0.05).margin(1e-6));
  CHECK(across.own_shift_right.value() == Approx(0.15).margin(1e-6));
}

TEST_CASE("the station of an obstacle does not depend on where a body's own frame begins") {
  Query query({}, straight_path(50), {.radius = 0.1});
  Body body{.name = "trailer", .model = {{0, 0, 0}}, .poses = {}, .path_pose = {}};
  for (std::uint32_t i = 0; i < query.poses.size(); ++i) {
    body.poses.push_back(translation({0.5 * i - 10, 0, 0}));
    body.path_pose.push_back(i);
  }
  query.bodies = {body};
  const Conflicts found = SearchedScene({{5, 0, 0}, {30, 0.02, 0}}, query).conflicts();
  REQUIRE(found.listed.size() == 2);
  CHECK(found.listed[0].obstacle_chainage.value() == Approx(5).margin(0.11));
  CHECK(found.listed[1].obstacle_chainage.value() == Approx(30).margin(0.11));
}
