#include "core/trajectory/motion_tree.hpp"

#include <cmath>

#include "core/geometry/predicate.hpp"
#include "core/trajectory/paths.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const Box kBodyOfTree{{-2, -1, 0}, {3, 1, 1.5}};

/// Checks that every node covers its poses, holds its mid and halves into its children, and that
/// its delta bounds the motion of random model points, between poses up to the next pose.
void check_tree(const std::vector<Pose>& poses, bool between_poses) {
  const MotionTree tree(poses, kBodyOfTree, between_poses);
  REQUIRE(tree.nodes().size() == 2 * poses.size() - 1);
  CHECK(tree.nodes()[0].count == poses.size());
  Random random(3);
  bool covered = true, bounded = true;
  for (std::uint32_t i = 0; i < tree.nodes().size(); ++i) {
    const MotionNode& node = tree.nodes()[i];
    covered &= node.mid >= node.first && node.mid < node.first + node.count;
    if (node.count > 1) {
      const MotionNode& earlier = tree.nodes()[i + 1];
      const MotionNode& later = tree.nodes()[node.later];
      covered &= earlier.first == node.first && later.first == node.first + earlier.count &&
                 earlier.count + later.count == node.count;
    } else {
      covered &= node.later == 0 && (between_poses || node.delta == 0);
    }
    for (int k = 0; k < 3; ++k) {
      const Vec3 m = random_point(random, kBodyOfTree);
      const bool moves_on = between_poses && node.first + node.count < poses.size();
      const auto pose =
          node.first + static_cast<std::uint32_t>(below(random, node.count + (moves_on ? 1u : 0u)));
      bounded &= distance(transform(poses[pose], m), transform(poses[node.mid], m)) <= node.delta;
    }
  }
  CHECK(covered);
  CHECK(bounded);
}

}  // namespace

TEST_CASE("a motion tree covers its poses and bounds their motion") {
  std::vector<Pose> poses;
  SECTION("one pose") { poses.push_back(headed(1, {1, 2, 3})); }
  SECTION("the same pose again and again") { poses.assign(100, headed(0.3, {5e6, 2e6, 1e3})); }
  SECTION("a curve") {
    for (int i = 0; i < 1000; ++i) poses.push_back(headed(i * 0.003, {i * 0.01, i * 0.002, 0}));
  }
  SECTION("turning on the spot") {
    for (int i = 0; i < 333; ++i) poses.push_back(headed(i * 0.02, {0, 0, 0}));
  }
  SECTION("stops, jumps and back") {
    for (int i = 0; i < 500; ++i) {
      const double far = i > 100 && i < 200 ? 1e4 : 0;
      poses.push_back(headed(0, {i < 300 ? 1.0 : i * 0.1, far, 0}));
    }
  }
  SECTION("steps that double") {
    for (int i = 0; i < 300; ++i) poses.push_back(headed(0, {std::ldexp(1e-30, i), 0, 0}));
  }
  check_tree(poses, false);
  check_tree(poses, true);
}

TEST_CASE("a jump separates the motion tree's halves") {
  std::vector<Pose> poses;
  for (int i = 0; i < 10; ++i) poses.push_back(headed(0, {i * 0.1, 0, 0}));
  for (int i = 0; i < 90; ++i) poses.push_back(headed(0, {1000 + i * 0.1, 0, 0}));
  const MotionTree tree(poses, kBodyOfTree);
  check_equal(tree.nodes()[1].count, 10);
  CHECK(tree.nodes()[1].delta < 1);
  CHECK(tree.nodes()[tree.nodes()[0].later].delta < 10);
}

TEST_CASE("pulling back uses the true inverse of a matrix that is not quite rigid") {
  const Pose pose{{1.0001, 1e-4, 0, -2e-4, 0.9999, 3e-4, 0, -1e-4, 1.0001}, {100, 200, 300}};
  const MotionTree tree(std::span(&pose, 1), kBodyOfTree);
  const Vec3 m{2.5, -0.5, 1.25};
  const Vec3 back = tree.pulled_back(0, transform(pose, m));
  CHECK(distance(back, m) < 1e-12);  // the transpose is off by 5e-4
  CHECK(tree.rounding(300) > 1e-13);
  CHECK(tree.rounding(300) < 1e-9);
}

TEST_CASE("singular values of a pull-back are bounds") {
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    Pose pose{};
    for (double& r : pose.rotation) r = uniform(random, -1, 1);
    for (int k = 0; k < 3; ++k) pose.rotation[4 * k] += 2;  // far from singular
    const MotionTree tree(std::span(&pose, 1), kBodyOfTree);
    const Vec3 v = random_point(random, {{-1, -1, -1}, {1, 1, 1}});
    const double before = length(v), after = length(transform(pose, v));
    CHECK(after >= tree.inverse_pose(0).least * before * (1 - 1e-12));
    CHECK(after <= tree.inverse_pose(0).greatest * before * (1 + 1e-12));
  }
}
