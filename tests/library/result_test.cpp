#include "clearway/result.hpp"

#include <cstring>

#include "support/catch.hpp"
#include "support/result_fixture.hpp"

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
