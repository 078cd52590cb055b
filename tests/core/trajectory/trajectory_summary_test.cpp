#include "core/trajectory/trajectory_summary.hpp"

#include <cmath>
#include <numbers>

#include "core/trajectory/chainage.hpp"
#include "core/trajectory/paths.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("a summary of no pose and of one") {
  check_equal(summarize_trajectory({}).poses, 0);
  const std::vector<Pose> one{turned_at(about_z(1), {1, 2, 3})};
  const TrajectorySummary summary = summarize_trajectory(one);
  check_equal(summary.poses, 1);
  check_equal(summary.length, 0);
  CHECK(summary.box.lo == Vec3{1, 2, 3});
  check_equal(summary.forward.cosine, 0);
  CHECK(summary.up.cosine == Approx(1));
}

TEST_CASE("a summary counts steps, turns and the box") {
  const std::vector<Pose> poses{
      turned_at(about_z(0), {0, 0, 0}), turned_at(about_z(0.5), {3, 4, 0}),
      turned_at(about_z(0.5), {3, 4, 0}), turned_at(about_z(0.25), {3, 5, -2}),
      turned_at(about_x(0.25) * about_z(0.25), {3, 5, 10})};
  const TrajectorySummary summary = summarize_trajectory(poses);
  CHECK(summary.length == Approx(5 + std::sqrt(5) + 12));
  CHECK(summary.median_step == Approx(5));
  CHECK(summary.largest_step == Approx(12));
  check_equal(summary.largest_step_pose, 3);
  check_equal(summary.still_steps, 1);
  CHECK(summary.largest_turn == Approx(0.5));
  check_equal(summary.largest_turn_pose, 0);
  CHECK(summary.total_turn == Approx(1));
  CHECK(summary.box.lo == Vec3{0, 0, -2});
  CHECK(summary.box.hi == Vec3{3, 5, 10});
  CHECK(summary.skew < 1e-15);
}

TEST_CASE("turns are exact when they are small, and up to a half turn") {
  const Pose identity = turned_at(about_z(0), {0, 0, 0});
  for (const double angle : {1e-9, 1e-3, 1.0, 3.0, std::numbers::pi}) {
    CHECK(turn_between(identity, turned_at(about_y(angle), {5, 5, 5})) ==
          Approx(angle).epsilon(1e-6));
  }
}

TEST_CASE("a summary names the axes that point up and ahead") {
  const auto on_a_circle = [](const Rotation& frame) {
    std::vector<Pose> poses = circle_poses(1.0 / 30, 0.6, 200);
    for (int i = 0; i < 200; ++i) {
      poses[i] = turned_at(about_z(0.02 * i) * frame, poses[i].position());
    }
    return summarize_trajectory(poses);
  };
  struct Row {
    const char* what;
    Rotation frame;
    int up, ahead;
    bool downwards, backwards;
  };
  for (const Row& row :
       {Row{"a car", about_z(0), 2, 0, false, false},
        Row{"a camera: x right, y down, z ahead", {0, 0, 1, -1, 0, 0, 0, -1, 0}, 1, 2, true, false},
        Row{"a mirrored car", {-1, 0, 0, 0, 1, 0, 0, 0, 1}, 2, 0, false, true}}) {
    const RowName name(row.what);
    const TrajectorySummary summary = on_a_circle(row.frame);
    check_equal(summary.up.axis, row.up);
    check_equal(summary.forward.axis, row.ahead);
    CHECK(summary.up.negative == row.downwards);
    CHECK(summary.forward.negative == row.backwards);
    CHECK(summary.forward.cosine > 0.999);
  }
}

TEST_CASE("skew is the distance from a rotation") {
  const std::vector<Pose> poses{{{1, 0, 0, 0, 1.01, 0, 0, 0, 1}, {0, 0, 0}}};
  CHECK(summarize_trajectory(poses).skew == Approx(1.01 * 1.01 - 1));
}

TEST_CASE("chainage is the length of the path so far") {
  const std::vector<Pose> poses{translation({5e5, 4e6, 100}), translation({5e5 + 3, 4e6 + 4, 100}),
                                translation({5e5 + 3, 4e6 + 4, 100}),
                                translation({5e5 + 3, 4e6, 97}), translation({5e5, 4e6, 97})};
  check_equal(chainage_of(poses), {0, 5, 5, 10, 13});
  CHECK(chainage_of({}).empty());
  check_equal(chainage_of({poses.data(), 1}), {0});
}
