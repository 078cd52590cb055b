#include <cstring>

#include "clearway/error.hpp"
#include "core/page/page.hpp"
#include "planned_scene.hpp"
#include "stream/plan.hpp"
#include "stream/run_pages.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/engines/page_runs.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Checks that the page holds what the cloud holds of every cell, value for value.
void check_page(const PackedCloud& cloud, std::span<const PlannedCell> cells, const PageRef& page) {
  REQUIRE(page.shape.cells == cells.size());
  std::uint64_t wrong = 0;
  for (std::uint32_t i = 0; i < cells.size(); ++i) {
    const PageCell& cell = page.cell(i);
    CHECK(cell.cell == cells[i].cell);
    CHECK(cell.count == cloud.cells()[cell.cell].count);
    CHECK(cell.box == cloud.cells()[cell.cell].box);
    REQUIRE(cell.node_count == cells[i].nodes.size());
    CHECK(std::equal(cells[i].nodes.begin(), cells[i].nodes.end(), page.nodes(cell)));
    const BlockBoxes blocks = cloud.blocks(cell.cell);
    for (std::uint32_t b = 0; b < cloud.blocks_per_cell(); ++b) {
      wrong += page.blocks(i)[b] != blocks[b];
    }
    const auto expected = cloud.coordinates(cell.cell);
    std::vector<std::int32_t> decoded(cloud.cell_points());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const PageChunk& chunk = cell.chunks[axis];
      packed_chunk(page, chunk, cloud.cell_points()).decode(0, decoded);
      for (std::uint32_t j = 0; j < cloud.cell_points(); ++j) {
        wrong += page.value(chunk, j) != expected[axis][j];
        wrong += decoded[j] != expected[axis][j];
      }
    }
  }
  check_equal(wrong, 0);
}

/// A cloud whose coordinates need 0 to 32 bits.
MemoryCloud cloud_of_bits(unsigned x_bits, unsigned y_bits, unsigned z_bits, std::size_t points,
                          std::uint32_t cell_points) {
  Random random(x_bits + 100 * y_bits + 10'000 * z_bits);
  const auto value = [&random](unsigned bits, std::size_t i) {
    const std::uint64_t end = std::uint64_t{1} << bits;
    const std::uint64_t delta = i == 0 ? 0 : i == 1 ? end - 1 : below(random, end);
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(delta - (end >> 1)));
  };
  std::vector<Quantum> out;
  for (std::size_t i = 0; i < points; ++i) {
    out.push_back({value(x_bits, i), value(y_bits, i), value(z_bits, i)});
  }
  return MemoryCloud(out, {{1, 1, 1}, {0, 0, 0}}, {cell_points, 0});
}

}  // namespace

TEST_CASE("a staged page holds what the cloud does, whatever the bits of a value") {
  for (unsigned bits = 0; bits <= 32; ++bits) {
    CAPTURE(bits);
    const MemoryCloud cloud = cloud_of_bits(bits, (bits * 7 + 3) % 33, 32 - bits, 205, 205);
    const auto cells = every_cell(cloud);
    PageMemory memory(smallest_page_bytes(cloud, cells), 0xff);
    const PageShape shape = stage_page(cloud, cells, memory.bytes());
    CHECK(cloud.coordinates(0)[0].minbits() == bits);
    check_page(cloud, cells, {memory.bytes().data(), shape});
  }
}

TEST_CASE("pages of several cells hold each of them, whatever the memory held before") {
  const PlannedScene scene({100, 900});
  for (const std::uint32_t most_cells : {1U, 3U, 1000U}) {
    const auto pages = paginate(scene.cloud, scene.cells, std::uint64_t{1} << 20, most_cells);
    for (const PlannedPage& planned : pages) {
      PageMemory a(planned.shape.bytes(), 0xff), b(planned.shape.bytes() + 4096, 0x5a);
      const auto cells = planned.of(scene.cells);
      const PageShape shape = stage_page(scene.cloud, cells, a.bytes());
      CHECK(shape.bytes() == planned.shape.bytes());
      check_page(scene.cloud, cells, {a.bytes().data(), shape});
      stage_page(scene.cloud, cells, b.bytes());
      check_equal(std::memcmp(a.bytes().data(), b.bytes().data(), shape.bytes()), 0);
      for (std::size_t i = shape.bytes(); i < b.bytes().size(); ++i) {
        if (b.bytes()[i] != std::byte{0x5a}) FAIL("written past the page");
      }
    }
  }
}

TEST_CASE("a damaged cell is not staged") {
  PlannedScene scene;
  const PlannedCell& damaged = scene.cells[scene.cells.size() / 2];
  scene.cloud.damage(damaged.cell);
  PageMemory memory(smallest_page_bytes(scene.cloud, scene.cells), 0);
  CHECK_THROWS_AS(stage_page(scene.cloud, std::span(&damaged, 1), memory.bytes()), InputError);
}

namespace {

Interval interval(int begin_ms, int end_ms) {
  const Clock::time_point start{std::chrono::hours(5)};
  return {start + std::chrono::milliseconds(begin_ms), start + std::chrono::milliseconds(end_ms)};
}

}  // namespace

TEST_CASE("busy time is the length of the union of the intervals") {
  struct Row {
    std::vector<Interval> intervals;
    int ms;
  };
  for (const auto& [intervals, ms] :
       {Row{{}, 0}, Row{{interval(10, 30)}, 20}, Row{{interval(10, 30), interval(40, 50)}, 30},
        Row{{interval(40, 50), interval(10, 30), interval(20, 45)}, 40},
        Row{{interval(10, 100), interval(20, 30), interval(40, 50)}, 90},
        Row{{interval(10, 30), interval(30, 40)}, 30},
        Row{{interval(10, 30), interval(10, 30)}, 20},
        // Intervals that were never set, and ends before begins, are no time.
        Row{{Interval{}, interval(10, 20), Interval{}}, 10}, Row{{interval(20, 10)}, 0},
        Row{{interval(0, 30), interval(20, 10), interval(25, 40)}, 40}}) {
    CHECK(busy_seconds(intervals) == Approx(ms * 1e-3));
  }
}

TEST_CASE("each stage's time is its own") {
  const StageTimes times = stage_times({{interval(0, 10), interval(5, 15), {}, interval(30, 31)},
                                        {interval(5, 20), interval(40, 50), {}, interval(40, 41)}});
  CHECK(times.read == Approx(0.020));
  CHECK(times.upload == Approx(0.020));
  check_equal(times.compute, 0);
  CHECK(times.collect == Approx(0.002));
}
