#include "stream/gather_rows.hpp"

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include "clearway/error.hpp"
#include "support/catch.hpp"
#include "support/clouds.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

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

/// Rows in memory that can be exchanged for others, as where the file that holds them changes.
class ChangingRows final : public RowStorage {
 public:
  std::uint64_t keep(JournalRecord& record) override { return now->keep(record); }
  JournalPayload read(std::uint64_t place, std::vector<std::byte>& bytes) const override {
    return now->read(place, bytes);
  }
  RowStorage* now = nullptr;
};

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

TEST_CASE("no row is put beside its place where the points change while they are read") {
  const ScratchFolder folder;
  write_las(folder / "a.las", cube_cloud(10'000, -1000, 1000, 1));
  convert_quietly(conversion_of({folder / "a.las"}, folder / "a.h5", 1000));
  const StoreReader store(folder / "a.h5");
  const Query query;
  const auto fill = [&](AnswerRows& rows, std::uint64_t bits) {
    const CellRows hits{.words = std::vector(store.blocks_per_cell() - 1, bits)};
    for (std::uint32_t cell = 0; cell < store.cells().size(); ++cell) {
      rows.add(cell, {{PointQuestion::kHits, hits}});
    }
  };
  RowsInMemory first;
  ChangingRows kept;
  kept.now = &first;
  AnswerRows answer(store, query, kept);
  fill(answer, 0xff);
  NoProgress progress;
  GatherRows<Row> gather(store, answer, PointQuestion::kHits, progress);
  std::vector<Row> rows(answer.points(PointQuestion::kHits));
  const auto rows_of = [](std::uint32_t, const CellRows&) {
    return [](std::uint64_t source, std::uint32_t i, std::size_t) { return Row{source, i}; };
  };
  const auto call = [&] { gather.gather(0, gather.counts().size(), rows, {}, rows_of); };
  call();
  CHECK(std::ranges::is_sorted(rows, {}, &Row::source));
  for (const std::uint64_t bits : {std::uint64_t{0x7f}, std::uint64_t{0xfffff}}) {
    RowsInMemory others;
    AnswerRows other(store, query, others);
    fill(other, bits);
    kept.now = &others;
    CHECK_THROWS_AS(call(), InputError);
  }
}
