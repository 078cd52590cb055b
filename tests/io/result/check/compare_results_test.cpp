#include <cmath>
#include <functional>

#include "clearway/error.hpp"
#include "io/result/sample_result.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;
using Kind = PointDifference::Kind;

namespace {

Comparison compare(const SampleTables& a, const SampleTables& b, std::size_t kept = 100) {
  const ScratchFolder folder;
  a.write(folder / "a.h5");
  b.write(folder / "b.h5");
  return compare_results(ResultReader(folder / "a.h5"), ResultReader(folder / "b.h5"), kept);
}

SampleTables sample(std::size_t count, bool first_pose = true) {
  return {sample_header(first_pose), count};
}

template <typename Rows>
void erase_row(Rows& rows, std::ptrdiff_t at) {
  for_each_column<Rows>([&](const auto& column) {
    auto& values = rows.*column.values;
    if (!values.empty()) values.erase(values.begin() + at);
  });
}

/// What differs in two queries: "model, radius".
std::string names_of(const std::vector<QueryDifference>& differences) {
  std::string names;
  for (const auto& one : differences) names += (names.empty() ? "" : ", ") + one.what;
  return names;
}

}  // namespace

TEST_CASE("a result equals itself") {
  const SampleTables a = sample(GENERATE(0u, 1u, 70'000u), GENERATE(false, true));
  const Comparison comparison = compare(a, a);
  CHECK(comparison.equal());
  CHECK(comparison.common == a.rows.size());
  CHECK(comparison.differing_first_poses.has_value() == a.header.first_pose);
  CHECK(comparison.queries.empty());
  CHECK(comparison.points.empty());
}

TEST_CASE("rows in one result only are found wherever they are") {
  const SampleTables full = sample(140'000);
  SampleTables less = full;
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
  SampleTables even = sample(100), odd = even;
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
  const SampleTables a = sample(10);
  SampleTables b = a;
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
  check_equal(names_of(without.queries), "first poses");
}

TEST_CASE("depths count where both results have them") {
  SampleTables a = sample(9);
  SampleTables b = a;
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
  const SampleTables a = sample(10, false);
  SampleTables b = a;
  b.rows.xyz[9].z = std::nextafter(b.rows.xyz[9].z, 0.0);
  const Comparison comparison = compare(a, b);
  CHECK_FALSE(comparison.equal());
  check_equal(comparison.differing_coordinates, 1);
  REQUIRE(comparison.points.size() == 1);
  CHECK(comparison.points[0].kind == Kind::kCoordinates);
}

TEST_CASE("every part of the query that differs is named, the sets decide") {
  const SampleTables a(full_header(5), 5);
  SampleTables b = a;
  b.header.model_hash ^= 1;
  b.header.radius = 0.25;
  b.header.between_poses = true;
  b.header.quantisation.offset[2] += 1;
  b.header.crs_wkt = "LOCAL_CS[\"site\"]";
  b.header.bodies[2] = "rear";
  const Comparison comparison = compare(a, b);
  CHECK(comparison.equal());
  check_equal(names_of(comparison.queries), "model, bodies, radius, motion, quantisation, CRS");
  const auto& queries = comparison.queries;
  check_equal(queries[0].a, "1234 points, hash 0123456789abcdef");
  check_equal(queries[1].b, "front bogie, body, rear");
  check_equal(queries[2].a, "0.1 m");
  check_equal(queries[2].b, "0.25 m");
  check_equal(queries[3].a, "at poses only");
  check_equal(queries[3].b, "between poses");
  const auto check = [&](const char* names, const std::function<void(ResultHeader&)>& change) {
    ResultHeader header = a.header;
    change(header);
    check_equal(names_of(query_differences(a.header, header)), names);
  };
  check("", [](ResultHeader&) {});
  check("trajectory", [](ResultHeader& header) { header.poses -= 1; });
  check("ignored points", [](ResultHeader& header) { header.ignore_classes = {2}; });
  check("ignored points", [](ResultHeader& header) { header.ignore_boxes.pop_back(); });
  check("classes", [](ResultHeader& header) { header.classes_hash = 7; });
  check("clearance", [](ResultHeader& header) { header.clearance = 0; });
  check("profile", [](ResultHeader& header) { header.profile = 0; });
}

TEST_CASE("clearances and profiles count where both results have them, bodies too") {
  const SampleTables a(full_header(100), 1000);
  SampleTables b = a;
  CHECK(compare(a, a).clearances == TableComparison{1000, 1000, 1000, 0, 0, 0});
  CHECK(compare(a, a).profiles == ProfileComparison{100, 0, std::nullopt});
  b.rows.body[5] = (b.rows.body[5] + 1) % 3;
  CHECK_FALSE(compare(a, b).equal());
  check_equal(compare(a, b).differing_first_poses, 1u);
  b.rows = a.rows;
  b.near.distance[5] = std::nextafter(b.near.distance[5], 0);
  b.near.body[6] = (b.near.body[6] + 1) % 3;
  b.near.pose[7] ^= 1;
  b.near.xyz[9].z += 0.01;
  erase_row(b.near, 3);
  CHECK_FALSE(compare(a, b).equal());
  CHECK(compare(a, b).clearances == TableComparison{1000, 999, 999, 1, 0, 4});
  b.near = a.near;
  b.profile.distance[51] = std::nextafter(b.profile.distance[51], 0);
  b.profile.source[60] ^= 1;
  b.profile.xyz[70].x += 1;
  CHECK_FALSE(compare(a, b).equal());
  CHECK(compare(a, b).profiles == ProfileComparison{100, 3, 51});
  b.header.trajectory_hash ^= 1;
  CHECK_FALSE(compare(a, b).profiles);
  ResultHeader without = a.header;
  without.clearance = without.profile = 0;
  const Comparison one_sided = compare(a, {without, 1000});
  CHECK(one_sided.equal());
  CHECK_FALSE(one_sided.clearances);
  CHECK_FALSE(one_sided.profiles);
  check_equal(names_of(one_sided.queries), "clearance, profile");
  check_equal(one_sided.queries[0].a, "0.5 m");
}

TEST_CASE("results about different environments are refused") {
  const SampleTables a = sample(5);
  SampleTables b = a;
  SECTION("another hash") { b.header.environment_hash ^= 1; }
  SECTION("another number of points") { b.header.environment_points += 1; }
  check_refused<InputError>([&] { return compare(a, b); },
                            "a.h5 ... b.h5 ... different environments ... fedcba9876543210");
}
