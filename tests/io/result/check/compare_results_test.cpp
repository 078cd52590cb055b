#include <cmath>

#include "clearway/error.hpp"
#include "io/result/check_results.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Kind = PointDifference::Kind;

namespace {

struct Side {
  ResultHeader header;
  Collisions rows;
};

Comparison compare(const Side& a, const Side& b, std::size_t kept = 100) {
  const ScratchFolder folder;
  write_result(folder / "a.h5", a.header, a.rows);
  write_result(folder / "b.h5", b.header, b.rows);
  return compare_results(ResultReader(folder / "a.h5"), ResultReader(folder / "b.h5"), kept);
}

Side sample(std::size_t count, bool first_pose = true) {
  const ResultHeader header = sample_header(first_pose);
  return {header, sample_rows(header, count)};
}

void erase_row(Collisions& rows, std::ptrdiff_t at) {
  rows.source.erase(rows.source.begin() + at);
  rows.xyz.erase(rows.xyz.begin() + at);
  if (rows.first_pose.empty()) return;
  rows.first_pose.erase(rows.first_pose.begin() + at);
  rows.last_pose.erase(rows.last_pose.begin() + at);
}

}  // namespace

TEST_CASE("a result equals itself") {
  const Side a = sample(GENERATE(0u, 1u, 70'000u), GENERATE(false, true));
  const Comparison comparison = compare(a, a);
  CHECK(comparison.equal());
  CHECK(comparison.common == a.rows.size());
  CHECK(comparison.differing_first_poses.has_value() == a.header.first_pose);
  CHECK(comparison.queries.empty());
  CHECK(comparison.points.empty());
}

TEST_CASE("rows in one result only are found wherever they are") {
  const Side full = sample(140'000);
  Side less = full;
  const std::vector<std::ptrdiff_t> missing{139'999, 131'072, 65'536, 65'535, 17, 0};
  for (const std::ptrdiff_t at : missing) erase_row(less.rows, at);

  const Comparison in_a = compare(full, less);
  CHECK_FALSE(in_a.equal());
  CHECK(in_a.only_in_a == missing.size());
  check_equal(in_a.only_in_b, 0);
  CHECK(in_a.common == less.rows.size());
  REQUIRE(in_a.points.size() == missing.size());
  for (std::size_t i = 0; i < missing.size(); ++i) {
    const auto at = static_cast<std::size_t>(missing[missing.size() - 1 - i]);
    CHECK(in_a.points[i].kind == Kind::kOnlyInA);
    CHECK(in_a.points[i].source == full.rows.source[at]);
    CHECK(in_a.points[i].xyz == full.rows.xyz[at]);
    CHECK(in_a.points[i].first_pose_a == full.rows.first_pose[at]);
    CHECK_FALSE(in_a.points[i].first_pose_b);
  }
  const Comparison in_b = compare(less, full, 2);
  CHECK(in_b.only_in_b == missing.size());
  check_equal(in_b.only_in_a, 0);
  check_equal(in_b.points.size(), 2);
  CHECK(in_b.points[0].kind == Kind::kOnlyInB);
}

TEST_CASE("disjoint results and an empty one have nothing in common") {
  Side even = sample(100), odd = even;
  for (std::size_t i = 0; i < 100; ++i) {
    even.rows.source[i] = 2 * i;
    odd.rows.source[i] = 2 * i + 1;
  }
  const Comparison disjoint = compare(even, odd, 3);
  check_equal(disjoint.common, 0);
  check_equal(disjoint.only_in_a, 100);
  check_equal(disjoint.only_in_b, 100);
  check_equal(disjoint.points[1].source, 1);
  const Comparison empty = compare(even, sample(0));
  check_equal(empty.only_in_a, 100);
  CHECK_FALSE(empty.equal());
}

TEST_CASE("first poses count where both results have them") {
  const Side a = sample(10);
  Side b = a;
  b.rows.first_pose[4] -= 1;
  const Comparison differing = compare(a, b);
  CHECK_FALSE(differing.equal());
  check_equal(differing.differing_first_poses, 1u);
  REQUIRE(differing.points.size() == 1);
  CHECK(differing.points[0].kind == Kind::kFirstPose);
  CHECK(differing.points[0].first_pose_a == a.rows.first_pose[4]);
  CHECK(differing.points[0].first_pose_b == b.rows.first_pose[4]);

  const Comparison without = compare(a, sample(10, false));
  CHECK(without.equal());
  CHECK_FALSE(without.differing_first_poses);
  REQUIRE(without.queries.size() == 1);
  check_equal(without.queries[0].what, "first poses");
}

TEST_CASE("depths count where both results have them") {
  Side a = sample(9);
  Side b = a;
  const Comparison without = compare(a, a);
  CHECK_FALSE(without.differing_depths);
  add_sample_depths(a.header, a.rows);
  const Comparison one = compare(a, b);
  CHECK(one.equal());
  CHECK_FALSE(one.differing_depths);
  REQUIRE(one.queries.size() == 1);

  add_sample_depths(b.header, b.rows);
  const Comparison same = compare(a, b);
  CHECK(same.equal());
  check_equal(same.differing_depths, 0u);

  b.rows.depth[0] += 0.5;
  b.rows.depth_source[4] -= 1;     // another free point at the same distance
  b.rows.depth[7] = std::nan("");  // nothing is free any more
  b.rows.depth_source[7] = Collisions::kNoPoint;
  const Comparison differing = compare(a, b);
  CHECK_FALSE(differing.equal());
  check_equal(differing.differing_depths, 3u);
  REQUIRE(differing.points.size() == 3);
  for (const PointDifference& point : differing.points) CHECK(point.kind == Kind::kDepth);
  CHECK(differing.points[0].depth_a == a.rows.depth[0]);
  CHECK(differing.points[0].depth_b == b.rows.depth[0]);
  CHECK(differing.points[1].depth_source_b == b.rows.depth_source[4]);
  CHECK(differing.points[2].depth_source_b == Collisions::kNoPoint);
}

TEST_CASE("coordinates of the same point that differ are a difference") {
  const Side a = sample(10, false);
  Side b = a;
  b.rows.xyz[9].z = std::nextafter(b.rows.xyz[9].z, 0.0);
  const Comparison comparison = compare(a, b);
  CHECK_FALSE(comparison.equal());
  check_equal(comparison.differing_coordinates, 1);
  REQUIRE(comparison.points.size() == 1);
  CHECK(comparison.points[0].kind == Kind::kCoordinates);
}

TEST_CASE("every part of the query that differs is named, the sets decide") {
  const Side a = sample(5);
  Side b = a;
  b.header.model_hash ^= 1;
  b.header.poses -= 1;
  b.header.radius = 0.25;
  b.header.between_poses = true;
  b.header.quantisation.offset[2] += 1;
  b.header.crs_wkt = "LOCAL_CS[\"site\"]";
  const Comparison comparison = compare(a, b);
  CHECK(comparison.equal());
  std::vector<std::string> named;
  for (const QueryDifference& query : comparison.queries) named.push_back(query.what);
  CHECK(named ==
        std::vector<std::string>{"model", "trajectory", "radius", "motion", "quantisation", "CRS"});
  check_equal(comparison.queries[0].a, "1234 points, hash 0123456789abcdef");
  check_equal(comparison.queries[2].a, "0.1 m");
  check_equal(comparison.queries[2].b, "0.25 m");
  check_equal(comparison.queries[3].a, "at poses only");
  check_equal(comparison.queries[3].b, "between poses");
}

TEST_CASE("results about different environments are refused") {
  const Side a = sample(5);
  Side b = a;
  SECTION("another hash") { b.header.environment_hash ^= 1; }
  SECTION("another number of points") { b.header.environment_points += 1; }
  CHECK_THROWS_AS(compare(a, b), InputError);
  check_refused([&] { return compare(a, b); },
                "a.h5 ... b.h5 ... different environments ... fedcba9876543210");
}
