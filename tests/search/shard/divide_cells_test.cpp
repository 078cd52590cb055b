#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>
#include <random>

#include "search/shard_cells.hpp"

using namespace clearway;

namespace {

/// Random work of cells: as in real scenes, a few cells have most of it and some have none.
std::vector<std::uint64_t> random_work(std::mt19937_64& draw, std::size_t cells) {
  std::vector<std::uint64_t> work(cells);
  for (std::uint64_t& one : work) one = draw() % 5 == 0 ? 0 : (draw() >> 54) * (draw() >> 54);
  return work;
}

}  // namespace

TEST_CASE("cells are divided so that no part has more than the mean and the largest cell") {
  std::mt19937_64 draw(17);
  for (const std::size_t cells : {0, 1, 2, 15, 100, 999}) {
    const std::vector<std::uint64_t> work = random_work(draw, cells);
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

TEST_CASE("cells without work are spread over all parts") {
  const std::vector<std::uint32_t> parts = divide_cells(std::vector<std::uint64_t>(100), 7);
  for (std::uint32_t part = 0; part < 7; ++part) CHECK(std::ranges::count(parts, part) >= 14);
}

TEST_CASE("of equal cells each part gets as many as every other") {
  const std::vector<std::uint32_t> parts = divide_cells(std::vector<std::uint64_t>(64, 5), 16);
  for (std::uint32_t part = 0; part < 16; ++part) CHECK(std::ranges::count(parts, part) == 4);
}
