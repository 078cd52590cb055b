#include <algorithm>
#include <cstdint>
#include <map>

#include "clearway/error.hpp"
#include "core/page/page_pool.hpp"
#include "core/query/search_result.hpp"
#include "planned_scene.hpp"
#include "stream/plan.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

void add_cell(PageShape& shape, const PackedCloud& cloud, const PlannedCell& cell) {
  ++shape.cells;
  shape.nodes += static_cast<std::uint32_t>(cell.nodes.size());
  shape.payload_bytes += cloud.packed_bytes(cell.cell);
}

/// Checks that every cell is in one page, in order, that sizes are right and within the bounds, and
/// that no page had room for the next cell.
void check_pages(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                 const std::vector<PlannedPage>& pages, std::uint64_t page_bytes,
                 std::uint32_t most_cells) {
  std::size_t next = 0;
  for (const PlannedPage& page : pages) {
    CHECK(page.first == next);
    CHECK(page.shape.cells > 0);
    CHECK(page.shape.cells <= most_cells);
    CHECK(page.shape.bytes() <= page_bytes);
    PageShape sum{.blocks_per_cell = cloud.blocks_per_cell()};
    for (const PlannedCell& cell : page.of(cells)) add_cell(sum, cloud, cell);
    CHECK(page.shape.nodes == sum.nodes);
    CHECK(page.shape.payload_bytes == sum.payload_bytes);
    next += page.shape.cells;
    if (next == cells.size()) continue;
    add_cell(sum, cloud, cells[next]);
    CHECK((sum.cells > most_cells || sum.bytes() > page_bytes));
  }
  CHECK(next == cells.size());
}

}  // namespace

TEST_CASE("pages hold every cell once, in order, within both bounds, as full as can be") {
  const PlannedScene scene;
  const auto all = every_cell(scene.cloud);
  for (const auto& cells : {scene.cells, all}) {
    const std::uint64_t least = smallest_page_bytes(scene.cloud, cells);
    for (const std::uint64_t bytes : {least, least + 1, 2 * least, 5 * least, 1000 * least}) {
      for (const std::uint32_t most : {1U, 2U, 7U, 100'000U}) {
        CAPTURE(bytes, most);
        check_pages(scene.cloud, cells, paginate(scene.cloud, cells, bytes, most), bytes, most);
      }
    }
  }
}

TEST_CASE("the smallest page holds the largest cell and no less") {
  const PlannedScene scene;
  std::uint64_t largest = 0;
  for (const PlannedCell& cell : scene.cells) {
    PageShape alone{.blocks_per_cell = scene.cloud.blocks_per_cell()};
    add_cell(alone, scene.cloud, cell);
    largest = std::max(largest, alone.bytes());
  }
  const std::uint64_t least = smallest_page_bytes(scene.cloud, scene.cells);
  CHECK(least == largest);
  CHECK_NOTHROW(paginate(scene.cloud, scene.cells, least, 1));
  check_refused([&] { return paginate(scene.cloud, scene.cells, least - 1, 1); },
                "at least " + std::to_string(least));
}

TEST_CASE("the motion nodes of a cell count in the size of its page") {
  const PlannedScene scene;
  auto cells = every_cell(scene.cloud);
  const std::uint64_t before = smallest_page_bytes(scene.cloud, cells);
  cells[4].nodes.assign(100'000, 1);
  const std::uint64_t least = smallest_page_bytes(scene.cloud, cells);
  CHECK(least >= before + 390'000);
  CHECK_THROWS_AS(paginate(scene.cloud, cells, least - 1, 8), ResourceError);
  check_pages(scene.cloud, cells, paginate(scene.cloud, cells, least, 8), least, 8);
}

TEST_CASE("no cells make no pages") {
  const PlannedScene scene;
  CHECK(paginate(scene.cloud, {}, 0, 1).empty());
  check_equal(smallest_page_bytes(scene.cloud, {}), 0);
}

TEST_CASE("slots are disjoint, aligned and as large as they say") {
  const PlannedScene scene;
  const std::uint64_t blocks = scene.cloud.blocks_per_cell(), entries = scene.cloud.cell_entries();
  for (const bool first_pose : {false, true}) {
    for (const double clearance : {0.0, 0.5}) {
      const Query query({}, {}, {.first_pose = first_pose, .clearance = clearance});
      const SlotLayout layout{3, 1001, 5};
      PagePool pool(scene.cloud, query, layout);
      std::uint64_t bytes = 0;
      const std::byte* last = nullptr;
      for (std::uint32_t slot = 0; slot < 3; ++slot) {
        const auto page = pool.page(slot);
        CHECK(page.size() >= 1001);
        check_equal(reinterpret_cast<std::uintptr_t>(page.data()) % kPageAlignment, 0);
        CHECK((last == nullptr || page.data() >= last));
        last = page.data() + page.size();
        check_equal(pool.hits(slot).size(), 5 * blocks);
        check_equal(pool.first_poses(slot).size(), first_pose ? 5 * entries : 0);
        check_equal(pool.clearances(slot).size(), clearance > 0 ? 5 * entries : 0);
        std::uint64_t found = 0;
        for (const std::uint64_t size :
             {pool.hits(slot).size_bytes(), pool.clearances(slot).size_bytes(),
              pool.first_poses(slot).size_bytes()}) {
          if (size > 0) found = ArrayRun::aligned(found) + size;
        }
        bytes += page.size() + found;
      }
      CHECK(bytes == 3 * PagePool::slot_bytes(scene.cloud, query, layout));
    }
  }
}

TEST_CASE("every cell with a colliding point is planned once, in the order of its first poses") {
  const PlannedScene scene;
  const auto& nodes = scene.motion.nodes();
  std::map<std::uint32_t, const PlannedCell*> planned;
  std::uint32_t last = 0;
  for (const PlannedCell& cell : scene.cells) {
    CHECK(planned.emplace(cell.cell, &cell).second);
    REQUIRE_FALSE(cell.nodes.empty());
    CHECK(nodes[cell.nodes.front()].first >= last);
    last = nodes[cell.nodes.front()].first;
    std::uint32_t end = 0;  // the nodes are disjoint, in the order of their poses
    for (const std::uint32_t index : cell.nodes) {
      CHECK(nodes[index].first >= end);
      end = nodes[index].first + nodes[index].count;
    }
    CHECK(end <= scene.query.poses.size());
  }
  CHECK(planned.size() > 5);
  CHECK(planned.size() < scene.cloud.cells().size());
  for (std::uint64_t entry = 0; entry < scene.cloud.entry_count(); ++entry) {
    if (!scene.cloud.is_used(entry)) continue;
    const std::uint32_t pose = scene.expected.first_poses(false)[scene.cloud.source(entry)];
    if (pose == kNoPose) continue;
    const PlannedCell& cell =
        *planned.at(static_cast<std::uint32_t>(entry / scene.cloud.cell_entries()));
    CHECK(std::ranges::any_of(cell.nodes, [&](std::uint32_t index) {
      return nodes[index].first <= pose && pose < nodes[index].first + nodes[index].count;
    }));
  }
  CHECK(scene.expected.colliding() > 20);
}

TEST_CASE("nothing is planned without points or without poses") {
  CHECK(PlannedScene({256, 0}, 0).cells.empty());
  CHECK(PlannedScene({256, 0}, 1000, 0).cells.empty());
}
