#include "core/query/ignored_points.hpp"

#include <limits>
#include <random>

#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/memory_cloud.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

Box box_of_x(double lo, double hi) { return {{lo, -10, -10}, {hi, 10, 10}}; }

}  // namespace

TEST_CASE("the integers in a box are those whose positions are, to the last bit") {
  const Quantisation quantisation{{0.001, 0.3, 1e-9}, {0.1, -7, 0}};
  for (const std::int32_t q : {-2'000'000'000, -1, 0, 1, 12345, 2'147'483'647}) {
    const double at = coordinate(quantisation, 0, q);
    const double below = std::nextafter(at, -1e300), above = std::nextafter(at, 1e300);
    const auto x_of = [&](double lo, double hi) {
      return quanta_in(quantisation, box_of_x(lo, hi));
    };
    REQUIRE(x_of(at, at));
    CHECK(x_of(at, at)->lo[0] == q);
    CHECK(x_of(at, at)->hi[0] == q);
    CHECK(x_of(below, above)->lo[0] == q);
    CHECK(x_of(below, above)->hi[0] == q);
    CHECK_FALSE(x_of(above, above));
    CHECK_FALSE(x_of(below, below));
  }
  const auto all = quanta_in(quantisation, box_of_x(-1e300, 1e300));
  REQUIRE(all);
  CHECK(all->lo[0] == std::numeric_limits<std::int32_t>::min());
  CHECK(all->hi[0] == std::numeric_limits<std::int32_t>::max());
  CHECK_FALSE(quanta_in(quantisation, box_of_x(1e9, 2e9)));
}

TEST_CASE("a mask has a bit for each point to be searched, and none behind the last") {
  std::mt19937 random(3);
  for (const std::size_t count : {1U, 63U, 64U, 65U, 999U}) {
    std::vector<Quantum> points;
    std::vector<std::uint8_t> classes;
    for (std::size_t i = 0; i < count; ++i) {
      const auto any = [&] { return static_cast<std::int32_t>(random() % 1000); };
      points.push_back({any(), any(), 0});
      classes.push_back(static_cast<std::uint8_t>(random() % 6));
    }
    const MemoryCloud cloud(points, classes, {{1, 1, 1}, {0, 0, 0}}, {1000, 0});
    QueryParameters query;
    query.ignore_classes = {1, 4};
    query.ignore_boxes = {{{0, 0, 0}, {300, 600, 0}}, {{2000, 0, 0}, {3000, 1, 1}}};
    std::vector<std::uint64_t> words(cloud.blocks_per_cell(), 0x5555);
    const std::uint32_t left_out =
        IgnoredPoints(cloud, query).mask(0, words, [&] { return cloud.coordinates(0); });
    std::uint32_t expected = 0, wrong = 0;
    for (std::uint32_t i = 0; i < cloud.cell_entries(); ++i) {
      const std::uint64_t source = i < count ? cloud.source(i) : 0;
      const bool is_out = i < count && (classes[source] == 1 || classes[source] == 4 ||
                                        (points[source][0] <= 300 && points[source][1] <= 600));
      expected += is_out;
      wrong += ((words[i / 64] >> (i % 64) & 1) != 0) != (i < count && !is_out);
    }
    check_equal(wrong, 0);
    CHECK(left_out == expected);
  }
}

TEST_CASE("the order of what is ignored does not matter, nor does saying it twice") {
  QueryParameters a, b;
  a.ignore_classes = {7, 2, 7};
  b.ignore_classes = {2, 7};
  a.ignore_boxes = {{{1, 2, 3}, {4, 5, 6}}, {{-0.0, 2, 3}, {4, 5, 6}}, {{1, 2, 3}, {4, 5, 6}}};
  b.ignore_boxes = {{{0, 2, 3}, {4, 5, 6}}, {{1, 2, 3}, {4, 5, 6}}};
  sort_ignored(a);
  CHECK(a == b);
  check_equal(ignored_text(a), "classes 2, 7 and 2 boxes");
  check_equal(ignored_text(a, {.points = 1234}), "1,234 points ignored (classes 2, 7 and 2 boxes)");
  check_equal(boxes_text(a.ignore_boxes), "0 2 3 to 4 5 6; 1 2 3 to 4 5 6");
}
