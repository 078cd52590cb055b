#include "stream/gather_rows.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>
#include <random>
#include <vector>

using namespace clearway;

namespace {

struct Row {
  std::uint64_t source;
  std::uint32_t number;
  friend bool operator==(const Row&, const Row&) = default;
};

/// So many rows of one part in random order.
std::vector<Row> shuffled(std::size_t count, std::mt19937_64& random) {
  std::vector<std::uint64_t> sources(SourceParts::kMostRows);
  std::iota(sources.begin(), sources.end(), 7 * SourceParts::kMostRows);
  std::ranges::shuffle(sources, random);
  std::vector<Row> rows;
  for (std::size_t i = 0; i < count; ++i) {
    rows.push_back({sources[i], static_cast<std::uint32_t>(i)});
  }
  return rows;
}

}  // namespace

TEST_CASE("rows of a part are ordered with a copy that has room, one that has not, and none") {
  std::mt19937_64 random(5);
  for (const std::size_t count : {0, 1, 2, 255, 256, 1000, 65'535, 65'536}) {
    const std::vector<Row> rows = shuffled(count, random);
    std::vector<Row> expected = rows;
    std::ranges::sort(expected, {}, &Row::source);
    for (const std::size_t room : {std::size_t{0}, count / 2, count, count + 9}) {
      CAPTURE(count, room);
      std::vector<Row> ordered = rows, copy(room);
      order_part(std::span(ordered), std::span(copy));
      CHECK((ordered == expected));
    }
  }
}

TEST_CASE("rows of a damaged store that have the same source index are kept, all of them") {
  std::mt19937_64 random(6);
  std::vector<Row> rows = shuffled(1000, random), copy(1000);
  rows[800].source = rows[30].source;
  std::vector<Row> ordered = rows;
  order_part(std::span(ordered), std::span(copy));
  CHECK(std::ranges::is_sorted(ordered, {}, &Row::source));
  std::ranges::sort(ordered, {}, &Row::number);
  CHECK((ordered == rows));
}
