#include <catch2/catch.hpp>

#include "clearway/error.hpp"
#include "planned_scene.hpp"
#include "stream/plan.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

namespace {

PageShape shape_alone(const PackedCloud& cloud, const PlannedCell& cell) {
  return {.cells = 1,
          .blocks_per_cell = cloud.blocks_per_cell(),
          .nodes = static_cast<std::uint32_t>(cell.nodes.size()),
          .payload_bytes = cloud.packed_bytes(cell.cell)};
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
    for (const PlannedCell& cell : page.of(cells)) {
      sum.nodes += static_cast<std::uint32_t>(cell.nodes.size());
      sum.payload_bytes += cloud.packed_bytes(cell.cell);
      ++sum.cells;
    }
    CHECK(page.shape.nodes == sum.nodes);
    CHECK(page.shape.payload_bytes == sum.payload_bytes);
    next += page.shape.cells;
    if (next == cells.size()) continue;
    ++sum.cells;
    sum.nodes += static_cast<std::uint32_t>(cells[next].nodes.size());
    sum.payload_bytes += cloud.packed_bytes(cells[next].cell);
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
    largest = std::max(largest, shape_alone(scene.cloud, cell).bytes());
  }
  const std::uint64_t least = smallest_page_bytes(scene.cloud, scene.cells);
  CHECK(least == largest);
  CHECK_NOTHROW(paginate(scene.cloud, scene.cells, least, 1));
  CHECK_THROWS_WITH(paginate(scene.cloud, scene.cells, least - 1, 1),
                    Contains("at least " + std::to_string(least)));
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
  CHECK(smallest_page_bytes(scene.cloud, {}) == 0);
}
