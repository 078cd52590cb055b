#include "search/shard_cells.hpp"

#include <catch2/catch.hpp>
#include <memory>

#include "clearway/error.hpp"
#include "support/result_fixture.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr std::uint64_t kEnough = std::uint64_t{1} << 30;

/// A store of points along a line, and a model that passes half of them.
struct HalfALine {
  explicit HalfALine(std::uint32_t cell_points = 64) {
    std::vector<Quantum> points;
    for (std::int32_t i = 0; i < 8000; ++i) points.push_back({10 * i, 0, 0});
    write_las(folder / "line.las", points, {{0.001, 0.001, 0.001}, {0, 0, 0}});
    convert_quietly(conversion_of({folder / "line.las"}, folder / "line.h5", cell_points));
    store = std::make_unique<StoreReader>(folder / "line.h5");
    query.model = {{0, 0.05, 0}, {0.3, 0.05, 0}};
    for (int i = 0; i < 400; ++i) {
      query.poses.push_back({{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.1 * i, 0, 0}});
    }
    query.radius = 0.1;
  }

  ShardCells cells(std::uint32_t number, std::uint32_t count, int threads = 2) const {
    return {*store, query, {number, count}, threads, kEnough};
  }

  ScratchFolder folder;
  std::unique_ptr<StoreReader> store;
  Query query;
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
    for (std::uint32_t number = 1; number <= count; ++number) {
      const ShardCells shard = line.cells(number, count);
      for (std::uint32_t cell = 0; cell < cells; ++cell) found[cell] += shard.contains(cell);
      CHECK(shard.part().division == line.cells(1, count).part().division);
    }
    CHECK(found == std::vector<int>(cells, 1));
  }
}

TEST_CASE("shards do not depend on threads but on store and query and number") {
  HalfALine line;
  const std::uint64_t division = line.cells(1, 7).part().division;
  CHECK(line.cells(3, 7, 1).part().division == division);
  CHECK(line.cells(1, 8).part().division != division);
  CHECK(HalfALine(128).cells(1, 7).part().division != division);
  line.query.poses.resize(100);
  CHECK(line.cells(1, 7).part().division != division);
}

TEST_CASE("work is estimated where the model comes and nowhere else") {
  const HalfALine line;
  const auto work = cell_work(*line.store, line.query, QueryTrees(line.query), 2);
  const auto cells = line.store->cells();
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    const Box box = position_box(line.store->quantisation(), cells[cell].box);
    if (box.hi.x < 40) CHECK(work[cell] > 0);
    if (box.lo.x > 41) CHECK(work[cell] == 0);
  }
}

TEST_CASE("shards of nothing have all cells too") {
  HalfALine line;
  line.query.poses.clear();
  CHECK(line.cells(1, 1).contains(0));
  CHECK(line.cells(1, 2).contains(0) != line.cells(2, 2).contains(0));
}

TEST_CASE("shards are refused where the memory is too little to divide") {
  const HalfALine line;
  CHECK_THROWS_AS(ShardCells(*line.store, line.query, {1, 2}, 2, 1 << 20), ResourceError);
}
