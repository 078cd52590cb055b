#include "clearway/result.hpp"

#include <catch2/catch.hpp>
#include <cstring>

#include "support/result_fixture.hpp"
#include "support/result_version_2.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("programs read profile, model box and the places of clearances") {
  const ScratchFolder folder;
  ResultHeader header = sample_header(false);
  header.poses = 12;
  header.profile = 0.75;
  header.clearance = 0.5;
  const Clearances clearances = sample_clearances(header, 9);
  const ProfileRows rows = sample_profile(header);
  write_result(folder / "a.h5", header, {}, 1000, clearances, rows);
  const Result result(folder / "a.h5");
  CHECK(result.parameters() == QueryParameters(header));
  CHECK(result.clearance().xyz == clearances.xyz);
  const Profile profile = result.profile();
  CHECK(profile.distance == rows.distance);
  CHECK(profile.source == rows.source);
  CHECK(profile.chainage == rows.chainage);
  REQUIRE(profile.xyz.size() == rows.xyz.size());  // bytes are compared, so that NaN equals NaN
  CHECK(std::memcmp(profile.xyz.data(), rows.xyz.data(), 12 * sizeof(Vec3)) == 0);
  CHECK(result.model_box() == header.model_box);
}

TEST_CASE("programs read results of version 2") {
  const ScratchFolder folder;
  write_version_2(folder / "a.h5");
  const Result result(folder / "a.h5");
  CHECK(result.source() == std::vector<std::uint64_t>{3, 8});
  CHECK(result.first_pose() == std::vector<std::uint32_t>{2, 0});
  const Clearances clearances = result.clearance();
  CHECK(clearances.source == std::vector<std::uint64_t>{3, 5, 8});
  CHECK(clearances.distance == std::vector<double>{0.05, 0.3, 0.02});
  CHECK(clearances.xyz.empty());
  CHECK(result.profile().distance.empty());
  CHECK_FALSE(result.model_box());
}
