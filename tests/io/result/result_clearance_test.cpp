#include <catch2/catch.hpp>

#include "io/result/check_results.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

namespace {

ResultHeader header_with_clearance() {
  ResultHeader header = sample_header(false);
  header.clearance = 0.75;
  return header;
}

std::optional<std::string> fault_of(const std::filesystem::path& path) {
  NoProgress progress;
  return verify_result(ResultReader(path), progress);
}

}  // namespace

TEST_CASE("clearances are read as they were written") {
  const ScratchFolder folder;
  const ResultHeader header = header_with_clearance();
  const std::size_t count = GENERATE(0u, 1u, 65'536u, 150'000u);
  const Collisions rows = sample_rows(header, 70'000);
  const Clearances clearances = sample_clearances(header, count);
  write_result(folder / "a.h5", header, rows, 1000, clearances);
  const ResultReader reader(folder / "a.h5");
  CHECK(same_answer(reader.header(), header));
  CHECK(reader.clearances() == count);
  const Clearances read = read_rows<Clearances>(reader);
  CHECK(read.source == clearances.source);
  CHECK(read.xyz == clearances.xyz);
  CHECK(read.distance == clearances.distance);
  CHECK(read.pose == clearances.pose);
  CHECK(same_rows(read_rows(reader), rows));
  CHECK_FALSE(fault_of(folder / "a.h5"));
  write_result(folder / "b.h5", header, rows, 69'999, clearances);
  CHECK(bytes_of(folder / "a.h5") == bytes_of(folder / "b.h5"));
}

TEST_CASE("a result without clearances has none") {
  const ScratchFolder folder;
  const ResultHeader header = sample_header(false);
  write_result(folder / "a.h5", header, sample_rows(header, 3));
  const ResultReader reader(folder / "a.h5");
  CHECK(reader.clearances() == 0);
  CHECK(read_rows<Clearances>(reader).size() == 0);
  ResultWriter writer(folder / "b.h5", header, 0);
  CHECK_THROWS_AS(writer.append(Clearances{}), std::logic_error);
}

TEST_CASE("a writer refuses clearances that do not belong to its result") {
  const ScratchFolder folder;
  const ResultHeader header = header_with_clearance();
  const Clearances rows = sample_clearances(header, 3);
  const auto append = [&](ResultWriter& writer, std::size_t first, std::size_t count) {
    writer.append(part_of(rows, first, count));
  };
  ResultWriter writer(folder / "a.h5", header, 0, 2);
  CHECK_THROWS_AS(append(writer, 0, 3), std::logic_error);
  append(writer, 1, 1);
  CHECK_THROWS_AS(append(writer, 0, 1), std::logic_error);
  CHECK_THROWS_AS(writer.finish(), std::logic_error);
  ResultWriter early(folder / "b.h5", header, 1, 1);
  CHECK_THROWS_AS(append(early, 0, 1), std::logic_error);  // clearances before the collisions
}

TEST_CASE("clearances that no run can have found are faults") {
  const ScratchFolder folder;
  const ResultHeader header = header_with_clearance();
  Clearances rows = sample_clearances(header, 70'000);
  const auto at = GENERATE(as<std::size_t>(), 0, 65'536, 69'999);
  std::string expected;
  SECTION("too far") { rows.distance[at] = std::nextafter(0.75, 1), expected = "distance"; }
  SECTION("negative") { rows.distance[at] = -1e-9, expected = "distance"; }
  SECTION("not a number") { rows.distance[at] = std::nan(""), expected = "distance"; }
  SECTION("nowhere") { rows.xyz[at].y = std::nan(""), expected = "xyz"; }
  SECTION("a pose past the end") { rows.pose[at] = 4'000'000'000, expected = "pose"; }
  SECTION("a point past the end") {
    rows.source.back() = header.environment_points, expected = "/clearance/source";
  }
  write_result(folder / "a.h5", header, {}, 1000, rows);
  const auto fault = fault_of(folder / "a.h5");
  REQUIRE(fault);
  CHECK_THAT(*fault, Contains("/clearance/") && Contains(expected) && Contains("row "));
}

TEST_CASE("clearances are compared where both results have them") {
  const ScratchFolder folder;
  const ResultHeader header = header_with_clearance();
  const Clearances a = sample_clearances(header, 1000);
  Clearances b = a;
  b.distance[5] = std::nextafter(b.distance[5], 0);
  b.pose[7] ^= 1;
  b.xyz[9].z += 0.01;
  b.source.erase(b.source.begin() + 3);
  b.xyz.erase(b.xyz.begin() + 3);
  b.distance.erase(b.distance.begin() + 3);
  b.pose.erase(b.pose.begin() + 3);
  write_result(folder / "a.h5", header, {}, 1000, a);
  write_result(folder / "b.h5", header, {}, 1000, b);
  ResultHeader without = header;
  without.clearance = 0;
  write_result(folder / "c.h5", without, {});
  const ResultReader ra(folder / "a.h5"), rb(folder / "b.h5"), rc(folder / "c.h5");
  CHECK(compare_results(ra, ra, 9).equal());
  const Comparison differing = compare_results(ra, rb, 9);
  CHECK_FALSE(differing.equal());
  CHECK(differing.clearances == TableComparison{1000, 999, 999, 1, 0, 3});
  const Comparison one_sided = compare_results(ra, rc, 9);
  CHECK(one_sided.equal());
  CHECK_FALSE(one_sided.clearances);
  REQUIRE(one_sided.queries.size() == 1);
  CHECK(one_sided.queries[0].a == "0.75 m");
}
