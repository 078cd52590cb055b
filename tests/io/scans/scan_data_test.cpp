#include <cmath>

#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"
#include "support/test_data.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

ReadCloud read_scan(const char* name) { return read_all(data_folder() / "formats" / name); }

Vec3 position_in_scan(const ReadCloud& cloud, std::size_t index) {
  if (cloud.quanta.empty()) return cloud.positions[index];
  const auto& q = cloud.quanta[index];
  return position(*cloud.info.quantisation, q[0], q[1], q[2]);
}

double largest_difference(const ReadCloud& a, const ReadCloud& b) {
  REQUIRE(a.size() == b.size());
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      largest =
          std::max(largest, std::abs(position_in_scan(a, i)[axis] - position_in_scan(b, i)[axis]));
    }
  }
  return largest;
}

}  // namespace

TEST_CASE("a PCD and a PTX are their LAS twins") {
  const auto pcd = read_scan("autzen-utm.pcd");
  REQUIRE(pcd.size() == 1065);
  check_equal(largest_difference(pcd, read_scan("autzen-utm.las")), 0);
  const auto ptx = read_scan("1.2-with-color.ptx");
  REQUIRE(ptx.size() == 1065);
  CHECK(largest_difference(ptx, read_scan("1.2-with-color.las")) < 1e-9);
}

TEST_CASE("an ascii PCD in commas is read with all its digits") {
  const auto cloud = read_scan("utm17_comma.pcd");
  REQUIRE(cloud.size() == 10);
  CHECK(cloud.positions[0] == Vec3{289814.15, 4320978.61, 170.76});
}

// The expected places are computed by hand as p' = p M, with the matrix of the file.
TEST_CASE("a PTX of a turned scanner is placed by its matrix, beams without a return are absent") {
  const auto reader = open_point_file(data_folder() / "formats" / "complex-transform.ptx");
  PointBatch batch;
  REQUIRE(reader->read(batch));
  REQUIRE(batch.size() == 12);
  check_equal(batch.absent.size(), 8);
  std::size_t placed = 0;
  for (const Vec3& p : batch.positions) placed += std::isfinite(p.x);
  check_equal(placed, 4);
}

TEST_CASE("a scan of 3DTK becomes right-handed metres") {
  const auto cloud = read_scan("3dtk/scan000.3d");
  REQUIRE(cloud.size() == 81'360);
  check_near(cloud.positions[0], {0, -0.101, 0}, 1e-15);
  check_near(cloud.positions[1], {0.000581712, -0.100996, -0.000662149}, 1e-15);
}
