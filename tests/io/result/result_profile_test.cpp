#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "clearway/error.hpp"
#include "clearway/result.hpp"
#include "io/result/check_results.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

namespace {

ResultHeader header_with_profile(std::uint64_t poses) {
  ResultHeader header = sample_header(true);
  header.poses = poses;
  header.clearance = 0.5;
  header.profile = 0.75;
  return header;
}

/// Whether two lists have the same bits, so that NaN equals NaN.
bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

std::optional<std::string> fault_of_profile(const std::filesystem::path& path) {
  NoProgress progress;
  return verify_result(ResultReader(path), progress);
}

}  // namespace

TEST_CASE("a profile is read as it was written") {
  const ScratchFolder folder;
  const auto poses = GENERATE(as<std::uint64_t>(), 0, 1, 65'536, 150'000);
  const ResultHeader header = header_with_profile(poses);
  const std::size_t others = poses == 0 ? 0 : 70'000;
  const Collisions rows = sample_rows(header, others);
  const Clearances clearances = sample_clearances(header, others);
  const ProfileRows profile = sample_profile(header);
  write_result(folder / "a.h5", header, rows, 1000, clearances, profile);
  const ResultReader reader(folder / "a.h5");
  CHECK(same_answer(reader.header(), header));
  CHECK(reader.profile_rows() == poses);
  const ProfileRows read = read_rows<ProfileRows>(reader);
  CHECK(read.distance == profile.distance);
  CHECK(read.source == profile.source);
  CHECK(same_bits(read.xyz, profile.xyz));
  CHECK(read.chainage == profile.chainage);
  CHECK(same_rows(read_rows(reader), rows));
  CHECK_FALSE(fault_of_profile(folder / "a.h5"));
  write_result(folder / "b.h5", header, rows, 69'999, clearances, profile);
  CHECK(bytes_of(folder / "a.h5") == bytes_of(folder / "b.h5"));
}

TEST_CASE("a result without a profile has none") {
  const ScratchFolder folder;
  write_result(folder / "a.h5", sample_header(false), {});
  const ResultReader reader(folder / "a.h5");
  CHECK(reader.profile_rows() == 0);
  CHECK(read_rows<ProfileRows>(reader).size() == 0);
  ResultWriter writer(folder / "b.h5", sample_header(false), 0);
  CHECK_THROWS_AS(writer.append(ProfileRows{}), std::logic_error);
}

TEST_CASE("a writer refuses a profile that does not belong to its result") {
  const ScratchFolder folder;
  const ResultHeader header = header_with_profile(3);
  const ProfileRows rows = sample_profile(header);
  const auto append = [&](ResultWriter& writer, std::size_t count, std::size_t sources) {
    ProfileRows part = part_of(rows, 0, count);
    part.source.resize(sources);
    writer.append(part);
  };
  ResultWriter writer(folder / "a.h5", header, 0);
  CHECK_THROWS_AS(append(writer, 3, 2), std::logic_error);
  append(writer, 2, 2);
  CHECK_THROWS_AS(append(writer, 2, 2), std::logic_error);
  CHECK_THROWS_AS(writer.finish(), std::logic_error);
  ResultWriter early(folder / "b.h5", header, 1);
  CHECK_THROWS_AS(append(early, 3, 3), std::logic_error);  // a profile before the collisions
}

TEST_CASE("a profile that no run can have found is a fault") {
  const ScratchFolder folder;
  const ResultHeader header = header_with_profile(70'000);
  ProfileRows rows = sample_profile(header);
  const auto at = GENERATE(as<std::size_t>(), 0, 65'536, 69'998);
  const double none = std::nan("");
  std::string expected;
  SECTION("too far") { rows.distance[at] = std::nextafter(0.75, 1), expected = "/distance"; }
  SECTION("negative") { rows.distance[at] = -1e-9, expected = "/distance"; }
  SECTION("not a number") { rows.distance[at] = none, expected = "/distance"; }
  SECTION("infinity with a point") {
    rows.distance[at] = std::numeric_limits<double>::infinity(), expected = "/distance";
  }
  SECTION("a distance without a point") {
    rows.source[at] = Profile::kNoPoint, rows.xyz[at] = {none, none, none};
    expected = "/distance";
  }
  SECTION("a point past the end") {
    rows.source[at] = header.environment_points, expected = "/source";
  }
  SECTION("a point nowhere") { rows.xyz[at].z = none, expected = "/xyz"; }
  SECTION("a place without a point") { rows.xyz[at + 4 - at % 5].x = 1, expected = "/xyz"; }
  SECTION("a path that goes back") {
    rows.chainage[at] = at == 0 ? -1 : rows.chainage[at - 1] - 0.5, expected = "/chainage";
  }
  SECTION("a chainage that is not a number") { rows.chainage[at] = none, expected = "/chainage"; }
  if (at + 4 - at % 5 >= rows.size() && expected == "/xyz" && !std::isnan(rows.xyz[at].z)) return;
  write_result(folder / "a.h5", header, {}, 1000, {}, rows);
  const auto fault = fault_of_profile(folder / "a.h5");
  REQUIRE(fault);
  CHECK_THAT(*fault, Contains("/profile" + expected) && Contains("row "));
}

TEST_CASE("a path that does not begin at 0 is a fault") {
  const ScratchFolder folder;
  const ResultHeader header = header_with_profile(3);
  ProfileRows rows = sample_profile(header);
  rows.chainage = {1, 1, 2};
  write_result(folder / "a.h5", header, {}, 1000, {}, rows);
  CHECK_THAT(fault_of_profile(folder / "a.h5").value_or(""), Contains("/profile/chainage, row 0"));
}

TEST_CASE("profiles are compared where both results have one of the same path") {
  const ScratchFolder folder;
  const ResultHeader header = header_with_profile(100);
  const ProfileRows a = sample_profile(header);
  ProfileRows b = a;
  b.distance[51] = std::nextafter(b.distance[51], 0);
  b.source[60] ^= 1;
  b.xyz[70].x += 1;
  ResultHeader elsewhere = header, without = header;
  elsewhere.trajectory_hash ^= 1;
  without.profile = 0;
  write_result(folder / "a.h5", header, {}, 1000, {}, a);
  write_result(folder / "b.h5", header, {}, 1000, {}, b);
  write_result(folder / "c.h5", elsewhere, {}, 1000, {}, a);
  write_result(folder / "d.h5", without, {});
  const ResultReader ra(folder / "a.h5"), rb(folder / "b.h5");
  CHECK(compare_results(ra, ra, 9).profiles == ProfileComparison{100, 0, std::nullopt});
  const Comparison differing = compare_results(ra, rb, 9);
  CHECK_FALSE(differing.equal());
  CHECK(differing.profiles == ProfileComparison{100, 3, 51});
  CHECK_FALSE(compare_results(ra, ResultReader(folder / "c.h5"), 9).profiles);
  const Comparison one_sided = compare_results(ra, ResultReader(folder / "d.h5"), 9);
  CHECK_FALSE(one_sided.profiles);
  REQUIRE(one_sided.queries.size() == 1);
  CHECK(one_sided.queries[0].what == "profile");
}
