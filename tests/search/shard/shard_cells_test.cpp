#include "search/shard_cells.hpp"

#include <algorithm>
#include <numeric>
#include <random>

#include "clearway/error.hpp"
#include "search/line_of_points.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr std::uint64_t kEnough = std::uint64_t{1} << 30;

/// A model that passes half of a line of points.
struct HalfALine : LineOfPoints {
  explicit HalfALine(std::uint32_t cell_points = 64)
      : LineOfPoints(8000, {{0, 0.05, 0}, {0.3, 0.05, 0}}, 400, cell_points) {}

  ShardCells cells(std::uint32_t number, std::uint32_t count, int threads = 2) const {
    return {*store, query, {number, count}, threads, kEnough};
  }
};

}  // namespace

TEST_CASE("every cell is in exactly one shard, also with more shards than cells") {
  const HalfALine line;
  const auto cells = static_cast<std::uint32_t>(line.store->cells().size());
  REQUIRE(cells > 100);
  REQUIRE(cells < 300);
  for (const std::uint32_t count : {1U, 2U, 7U, 64U, cells, 300U}) {
    CAPTURE(count);
    std::vector<int> found(cells);
    const std::uint64_t division = line.cells(1, count).part().division;
    for (std::uint32_t number = 1; number <= count; ++number) {
      const ShardCells shard = line.cells(number, count);
      for (std::uint32_t cell = 0; cell < cells; ++cell) found[cell] += shard.contains(cell);
      CHECK(shard.part().division == division);
    }
    CHECK(found == std::vector<int>(cells, 1));
  }
}

TEST_CASE("shards depend on store, query and number, and on no threads") {
  HalfALine line;
  const std::uint64_t division = line.cells(1, 7).part().division;
  CHECK(line.cells(3, 7, 1).part().division == division);
  CHECK(line.cells(1, 8).part().division != division);
  CHECK(HalfALine(128).cells(1, 7).part().division != division);
  line.query.poses.resize(100);
  CHECK(line.cells(1, 7).part().division != division);
  line.query.poses.clear();  // what divides nothing has all cells too
  CHECK(line.cells(1, 1).contains(0));
  CHECK(line.cells(1, 2).contains(0) != line.cells(2, 2).contains(0));
  CHECK_THROWS_AS(ShardCells(*line.store, line.query, {1, 2}, 2, 1 << 20), ResourceError);
}

TEST_CASE("work is estimated where the model comes and nowhere else") {
  const HalfALine line;
  const auto work = cell_work(*line.store, line.query, QueryTrees(line.query), 2);
  const auto cells = line.store->cells();
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    const Box box = position_box(line.store->quantisation(), cells[cell].box);
    if (box.hi.x < 40) CHECK(work[cell] > 0);
    if (box.lo.x > 41) check_equal(work[cell], 0);
  }
}

TEST_CASE("cells are divided so that no part has more than the mean and the largest cell") {
  std::mt19937_64 draw(17);
  for (const std::size_t cells : {0, 1, 2, 15, 100, 999}) {
    // As in real scenes, a few cells have most of the work and some have none.
    std::vector<std::uint64_t> work(cells);
    for (std::uint64_t& one : work) one = draw() % 5 == 0 ? 0 : (draw() >> 54) * (draw() >> 54);
    for (const std::uint32_t shards : {1, 2, 7, 16, 64, 1000}) {
      CAPTURE(cells, shards);
      const std::vector<std::uint32_t> parts = divide_cells(work, shards);
      REQUIRE(parts.size() == cells);
      std::vector<std::uint64_t> load(shards);
      for (std::size_t cell = 0; cell < cells; ++cell) {
        REQUIRE(parts[cell] < shards);
        load[parts[cell]] += work[cell];
      }
      const std::uint64_t all = std::accumulate(work.begin(), work.end(), std::uint64_t{0});
      const std::uint64_t largest = cells == 0 ? 0 : *std::ranges::max_element(work);
      CHECK(*std::ranges::max_element(load) <= all / shards + largest);
      CHECK(parts == divide_cells(work, shards));
    }
  }
}

TEST_CASE("of equal cells each part gets as many as every other, be they without work") {
  const std::vector<std::uint32_t> idle = divide_cells(std::vector<std::uint64_t>(100), 7);
  for (std::uint32_t part = 0; part < 7; ++part) CHECK(std::ranges::count(idle, part) >= 14);
  const std::vector<std::uint32_t> equal = divide_cells(std::vector<std::uint64_t>(64, 5), 16);
  for (std::uint32_t part = 0; part < 16; ++part) check_equal(std::ranges::count(equal, part), 4);
}
