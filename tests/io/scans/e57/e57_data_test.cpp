// Public E57 files. The expected values are what libE57Format reads, with poses applied in numpy.
#include <bit>
#include <cmath>

#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"
#include "support/test_data.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

ReadCloud read_sample(const char* name) { return read_all(data_folder() / "formats" / name); }

/// A hash of positions: h = 31 h + bits over all coordinates, modulo 2^64.
std::uint64_t hash_of(const std::vector<Vec3>& positions) {
  std::uint64_t hash = 0;
  for (const Vec3& p : positions) {
    for (int k = 0; k < 3; ++k) hash = hash * 31 + std::bit_cast<std::uint64_t>(p[k]);
  }
  return hash;
}

}  // namespace

TEST_CASE("one scan as E57 doubles, integers of 32 and of 21 bits has the same bits") {
  for (const char* name : {"bunnyDouble.e57", "bunnyInt32.e57", "cry_bunnyInt21.e57"}) {
    INFO(name);
    const ReadCloud cloud = read_sample(name);
    REQUIRE(cloud.positions.size() == 30571);
    check_equal(cloud.info.declared_points, 30571);
    CHECK(cloud.info.unit == LengthUnit::kMetre);
    CHECK(cloud.info.remarks.empty());
    CHECK(cloud.positions.front() == Vec3{-0.07063, 0.04015, 0.0012259999999999999});
    CHECK(cloud.positions.back() == Vec3{-0.037829, 0.12794, 0.004474});
    check_equal(hash_of(cloud.positions), 17450273413105548677U);
  }
}

TEST_CASE("a real spherical scan, a posed one and one without points") {
  const ReadCloud sphere = read_sample("cry_tiny_spherical.e57");
  REQUIRE(sphere.positions.size() == 360);
  std::size_t absent = 0;
  for (std::size_t i = 0; i < 360; ++i) {
    const Vec3& p = sphere.positions[i];
    CHECK(std::isnan(p.x) == (i % 2 == 1));
    if (std::isnan(p.x)) {
      ++absent;
    } else {
      CHECK(std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z) == Approx(1).margin(1e-15));
    }
  }
  check_equal(absent, 180);
  REQUIRE(sphere.info.remarks.size() == 1);
  check_says(sphere.info.remarks[0].text, "180 of 360 records have no valid point");

  const ReadCloud posed = read_sample("pye57_translationWithoutRotation.e57");
  REQUIRE(posed.positions.size() == 4);
  CHECK(posed.positions.front() == Vec3{4, 5, 6});
  CHECK(posed.positions.back() == Vec3{5, 6, 6});
  REQUIRE(posed.info.remarks.size() == 1);
  check_says(posed.info.remarks[0].text, "1 scan; 1 pose is applied");

  check_equal(read_sample("zero-points-valid.e57").size(), 0);
}
