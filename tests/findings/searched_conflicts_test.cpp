// Conflicts of real searches: their poses, stations, sides and shifts, against brute force.
#include <cmath>

#include "clearway/clearway.hpp"
#include "core/geometry/quantisation.hpp"
#include "core/query/search_result.hpp"
#include "findings/searched_scene.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/engines/brute_force.hpp"
#include "support/scenes.hpp"
#include "support/solid_scene.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A search and the conflicts that it finds.
struct Scene : SearchedScene {
  using SearchedScene::SearchedScene;

  Conflicts conflicts(std::vector<std::uint32_t>* conflict_of = nullptr) const {
    ConflictOptions options;
    options.gap = 0.3;
    options.min_points = 1;
    options.model = &query.model;
    options.threads = 2;
    return find_conflicts(Result(folder / "out.h5"), query.poses, options, conflict_of);
  }

  /// Whether any point of the group collides at the conflict's poses, first to last, of the shifted
  /// path.
  bool collides(const std::vector<Vec3>& group, const Conflict& conflict, double shift) const {
    Query moved = query;
    moved.between_poses = false;
    moved.poses.clear();
    for (std::uint32_t i = conflict.first_pose; i <= conflict.last_pose; ++i) {
      Pose pose = query.poses[i];
      for (int k = 0; k < 3; ++k) pose.translation[k] += shift * pose.rotation[3 * k + 1];
      moved.poses.push_back(pose);
    }
    for (const std::uint32_t first : brute_force_first_poses(group, moved)) {
      if (first != kNoPose) return true;
    }
    return false;
  }
};

std::vector<Vec3> pole(double x, double y) {
  std::vector<Vec3> out;
  for (int i = 0; i < 40; ++i) out.push_back({x, y, 0.05 * i});
  return out;
}

Query solid_box(const Box& box, std::vector<Pose> poses, double radius) {
  Bodies bodies;
  bodies.add(box_surface(box));
  return bodies.query(std::move(poses), radius);
}

}  // namespace

TEST_CASE("a conflict's poses hold the one of its least distance, and shifts free its points") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const Box room{{0, -3, 0}, {12, 3, 2}};
    std::vector<Vec3> model = random_points(random, {{-0.6, -0.4, 0}, {0.6, 0.4, 0.8}}, 60);
    Query query(std::move(model), smooth_path(random, room, 60),
                {.radius = 0.15, .clearance = 0.3});
    const Scene scene(random_points(random, room, 3000), query);
    std::vector<std::uint32_t> conflict_of;
    const Conflicts found = scene.conflicts(&conflict_of);
    REQUIRE(found.listed.size() > 1);
    const Result result(scene.folder / "out.h5");
    const auto first = result.first_pose(), last = result.last_pose();
    const auto source = result.source();
    for (const Conflict& conflict : found.listed) {
      REQUIRE(conflict.nearest_pose);
      CHECK(conflict.first_pose <= *conflict.nearest_pose);
      CHECK(*conflict.nearest_pose <= conflict.last_pose);
      std::uint32_t from = kNoPose, to = 0;
      std::vector<Vec3> group;
      for (std::size_t row = 0; row < source.size(); ++row) {
        if (conflict_of[row] != conflict.id) continue;
        from = std::min(from, first[row]);
        to = std::max(to, last[row]);
        group.push_back(scene.points[source[row]]);
      }
      CHECK(conflict.first_pose == from);
      CHECK(conflict.last_pose == to);
      for (const auto& [shift, side] :
           {std::pair(conflict.own_shift_left, 1.0), std::pair(conflict.own_shift_right, -1.0)}) {
        if (!shift) continue;
        CHECK_FALSE(scene.collides(group, conflict, side * (*shift + 1e-6)));
        for (int step = 0; step < 20; ++step) {
          CHECK(scene.collides(group, conflict, side * (*shift - 1e-6) * step / 19));
        }
      }
    }
  }
}

TEST_CASE("a pole that a long load meets in its middle is named with station, side and shift") {
  // The load swings: at 20 m the path turns to the left, and its middle cuts the corner.
  std::vector<Pose> poses;
  for (int i = 0; i <= 80; ++i) {
    const double turn = 0.01 * i;
    poses.push_back(rotation({0, 0, 1}, turn, {50 * std::sin(turn), 50 * (1 - std::cos(turn)), 0}));
  }
  const Pose& middle = poses[40];
  // This point is 1.4 m to the left of the middle of the load, whose side is at 1.5 m, so 0.1 m
  // inside it.
  const double *r = middle.rotation, *t = middle.translation;
  const Vec3 at{t[0] + 1.4 * r[1], t[1] + 1.4 * r[4], 0};
  for (const bool solid : {true, false}) {
    CAPTURE(solid);
    Query query = solid_box({{-15, -1.5, 0.2}, {15, 1.5, 3}}, poses, 0.1);
    if (!solid) query.model.solid_of.clear();
    query.clearance = 0.2;
    const Scene scene(pole(at.x, at.y), query);
    const Conflicts found = scene.conflicts();
    REQUIRE(found.listed.size() == 1);
    const Conflict& c = found.listed[0];
    CHECK(c.side == Side::kLeft);
    REQUIRE(c.obstacle_chainage);
    // The pole stands beside the pose in the middle of the path, at 0.4 rad of 50 m.
    CHECK(*c.obstacle_chainage == Approx(20).margin(0.5));
    REQUIRE(c.own_shift_right);
    CHECK(*c.own_shift_right > 0.2);
    CHECK_FALSE(scene.collides(scene.points, c, -(*c.own_shift_right + 1e-6)));
    CHECK(scene.collides(scene.points, c, -(*c.own_shift_right - 1e-6)));
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
    const Conflicts found = Scene(wall, query).conflicts();
    REQUIRE(found.listed.size() == 1);
    CHECK(found.listed[0].first_touch == Side::kFront);
    CHECK(*found.listed[0].obstacle_chainage == Approx(12.1).margin(1e-9));
    // The conflict reaches from the pose at 10 m, whose front is at 12 m, to where the rear at -2 m
    // has passed.
    check_equal(found.listed[0].chainage_from, 10);
    check_equal(found.listed[0].chainage_to, 14);
  }
}

TEST_CASE("between poses the range ends with the pose after the last way that touches") {
  Query query({{0, 0, 0.5}}, straight_path(10), {.radius = 0.1, .between_poses = true});
  const Scene scene({{4.25, 0.05, 0.5}}, query);
  const Conflicts found = scene.conflicts();
  REQUIRE(found.listed.size() == 1);
  const Conflict& c = found.listed[0];
  check_equal(c.first_pose, 8);
  check_equal(c.last_pose, 8);
  check_equal(c.chainage_from, 4);
  check_equal(c.chainage_to, 4.5);
  CHECK(*c.obstacle_chainage == Approx(4.25));
}

TEST_CASE("groups that are too small to be listed are told one by one") {
  Query query({{0, 0, 0.5}}, straight_path(10), {.radius = 0.1});
  const Scene scene({{4, 0, 0.5}, {4, 0.05, 0.5}, {8, 0, 0.5}}, query);
  ConflictOptions options;
  options.min_points = 10;
  const Conflicts found =
      find_conflicts(Result(scene.folder / "out.h5"), scene.query.poses, options);
  CHECK(found.listed.empty());
  REQUIRE(found.small.size() == 2);
  check_equal(found.small_points, 3);
  check_equal(found.small[0].points, 2);
  check_equal(found.small[0].chainage_from, 4);
  check_equal(found.small[1].source, 2);
  check_equal(found.small[1].chainage_from, 8);
}

TEST_CASE("between poses, shifts free the ways too") {
  Query query;
  query.model = {{0, 0, 0}};
  query.poses = {rotation({0, 0, 1}, 0, {0, 0, 0}), rotation({0, 0, 1}, 0, {10, 0, 0})};
  query.radius = 0.1;
  query.between_poses = true;
  const Scene scene({{5, 0.05, 0}}, query);
  const Conflicts found = scene.conflicts();
  REQUIRE(found.listed.size() == 1);
  REQUIRE(found.listed[0].own_shift_left);
  REQUIRE(found.listed[0].own_shift_right);
  CHECK(*found.listed[0].own_shift_left == Approx(0.15).margin(1e-6));
  CHECK(*found.listed[0].own_shift_right == Approx(0.05).margin(1e-6));
}

TEST_CASE("left and right of a shift are those of the side, whichever axis points ahead") {
  Query query;
  query.model = {{0, 0, 0}};
  for (int i = 0; i <= 20; ++i) {
    query.poses.push_back(rotation({0, 0, 1}, 0, {0, 0.05 * i, 0}));
  }
  query.radius = 0.1;
  const Scene scene({{0.05, 0.5, 0}}, query);
  ConflictOptions options;
  options.min_points = 1;
  options.model = &scene.query.model;
  options.forward = Axis::kPlusY;
  const Conflicts found = find_conflicts(Result(scene.folder / "out.h5"), query.poses, options);
  REQUIRE(found.listed.size() == 1);
  REQUIRE(found.listed[0].lateral);
  CHECK(*found.listed[0].lateral == Approx(-0.05));  // to the right
  CHECK(found.listed[0].own_shift_left.value() == Approx(0.05).margin(1e-6));
  CHECK(found.listed[0].own_shift_right.value() == Approx(0.15).margin(1e-6));
}

TEST_CASE("the station of an obstacle does not depend on where a body's own frame begins") {
  std::vector<Pose> path, behind;
  for (int i = 0; i <= 100; ++i) {
    path.push_back(rotation({0, 0, 1}, 0, {0.5 * i, 0, 0}));
    behind.push_back(rotation({0, 0, 1}, 0, {0.5 * i - 10, 0, 0}));
  }
  Query query;
  query.poses = path;
  query.radius = 0.1;
  Body body{.name = "trailer", .model = {{0, 0, 0}}, .poses = behind, .path_pose = {}};
  for (std::uint32_t i = 0; i < path.size(); ++i) body.path_pose.push_back(i);
  query.bodies = {body};
  const Scene scene({{5, 0, 0}, {30, 0.02, 0}}, query);
  ConflictOptions options;
  options.min_points = 1;
  options.bodies = query.bodies;
  const Conflicts found = find_conflicts(Result(scene.folder / "out.h5"), path, options);
  REQUIRE(found.listed.size() == 2);
  CHECK(found.listed[0].obstacle_chainage.value() == Approx(5).margin(0.11));
  CHECK(found.listed[1].obstacle_chainage.value() == Approx(30).margin(0.11));
}
