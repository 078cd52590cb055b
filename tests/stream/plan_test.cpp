#include "stream/plan.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "core/query/search_result.hpp"
#include "cpu/brute_force.hpp"
#include "planned_scene.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("a plan names every cell once, in the order of the first poses") {
  const PlannedScene scene;
  std::set<std::uint32_t> seen;
  std::uint32_t last = 0;
  for (const PlannedCell& cell : scene.cells) {
    CHECK(seen.insert(cell.cell).second);
    REQUIRE_FALSE(cell.nodes.empty());
    const std::uint32_t first = scene.motion.nodes()[cell.nodes.front()].first;
    CHECK(first >= last);
    last = first;
  }
  CHECK(seen.size() > 5);
  CHECK(seen.size() < scene.cloud.cells().size());
}

TEST_CASE("the nodes of a planned cell are disjoint, in the order of their poses") {
  const PlannedScene scene;
  for (const PlannedCell& cell : scene.cells) {
    std::uint32_t end = 0;
    for (const std::uint32_t index : cell.nodes) {
      const MotionNode& node = scene.motion.nodes()[index];
      CHECK(node.first >= end);
      end = node.first + node.count;
    }
    CHECK(end <= scene.poses.size());
  }
}

TEST_CASE("every cell with a colliding point is planned, with the point's first pose") {
  const PlannedScene scene;
  const auto first_poses =
      brute_force_first_poses(positions_of(scene.cloud_points, kTenths), scene.query);
  std::uint64_t colliding = 0;
  for (std::uint64_t slot = 0; slot < scene.cloud.entry_count(); ++slot) {
    if (!scene.cloud.is_used(slot)) continue;
    const std::uint32_t pose = first_poses[scene.cloud.source(slot)];
    if (pose == HitSet::kNever) continue;
    ++colliding;
    const auto cell = std::find_if(
        scene.cells.begin(), scene.cells.end(),
        [&](const PlannedCell& c) { return c.cell == slot / scene.cloud.cell_entries(); });
    REQUIRE(cell != scene.cells.end());
    CHECK(std::any_of(cell->nodes.begin(), cell->nodes.end(), [&](std::uint32_t index) {
      const MotionNode& node = scene.motion.nodes()[index];
      return node.first <= pose && pose < node.first + node.count;
    }));
  }
  CHECK(colliding > 20);
}

TEST_CASE("nothing is planned without points or without poses") {
  CHECK(PlannedScene({256, 0}, 0).cells.empty());
  CHECK(PlannedScene({256, 0}, 1000, 0).cells.empty());
}
