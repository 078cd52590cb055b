// Public files of every format.
#include <bit>
#include <cmath>
#include <sstream>

#include "clearway/model.hpp"
#include "clearway/trajectory.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"
#include "support/test_data.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

ReadCloud read_sample(const std::string& name) {
  return read_all(data_folder() / "formats" / name);
}

/// A hash of positions: h = 31 h + bits over all coordinates, modulo 2^64.
std::uint64_t hash_of(const std::vector<Vec3>& positions) {
  std::uint64_t hash = 0;
  for (const Vec3& p : positions) {
    for (int k = 0; k < 3; ++k) hash = hash * 31 + std::bit_cast<std::uint64_t>(p[k]);
  }
  return hash;
}

}  // namespace

TEST_CASE("every file loads with its header's count, unit, first and last point") {
  // Name, number of points, unit, and the coordinates of the first and last point
  constexpr const char* kFiles[] = {
      "1.0_0.las 1 metre 470692.44 4602888.9 16 470692.44 4602888.9 16",
      "1.1_1.las 1 metre 470692.44 4602888.9 16 470692.44 4602888.9 16",
      "1.2-with-color.las 1065 unknown 637012.24 849028.31 431.66 637342.85 853240.32 423.92",
      "1.2_3.las 1 metre 470692.44 4602888.9 16 470692.44 4602888.9 16",
      "1_4_w_evlr.las 1000 us-survey-foot 1694510.386934684 1816497.966263977 5598.359612815 "
      "1694291.636332656 1816493.066230585 5597.089652538",
      "autzen-utm.las 1065 metre 494428.61 4877455.58 131.57 494490.24 4878741.67 129.21",
      "autzen_trim_7.las 110000 foot 637177.98 849393.95 411.19 636037.88 849336.94 423.2",
      "epsg_4326.las 5380 degree -94.6639387 31.0367341 47.8700002 -94.6803588 31.0473291 "
      "52.6800002",
      "extrabytes.las 1065 unknown 637012.24 849028.31 431.66 637342.85 853240.32 423.92",
      "no-points-1.3.las 0 unknown",
      "rand1_6.las 50000 unknown 1351727964 581869302 1742863086 92095808 -1752414158 1157661265",
      // By the key of geodetic systems
      "simple1_3.las 999 metre -234935.841 5800843.145 265.094 -235433.76 5800946.08 273.729",
      "simple1_4.las 22600 degree 1 1 100 226 100 185",
      "test1_4.las 1000 us-survey-foot 1694510.386934684 1816497.966263977 5598.359612815 "
      "1694291.636332656 1816493.066230585 5597.089652538",
      "simple_text.ply 3 unknown -1 0 0 1 0 0",
      "text_extradim.ply 1 unknown -2.64944 -13.0955 0.00640115 -2.64944 -13.0955 0.00640115",
      "autzen.pts 10 unknown 636110.300003 849345.050003 512.139999 636125.87999 848971.060013 "
      "428.050003",
      "simple_binary.ply 3 unknown -1 0 0 1 0 0",
      "bunnyDouble.e57 30571 metre -0.07063 0.04015 0.001226 -0.037829 0.12794 0.004474",
      "bunnyInt32.e57 30571 metre -0.07063 0.04015 0.001226 -0.037829 0.12794 0.004474",
      "cry_bunnyInt21.e57 30571 metre -0.07063 0.04015 0.001226 -0.037829 0.12794 0.004474",
      "zero-points-valid.e57 0 metre"};
  for (const char* file : kFiles) {
    const RowName row(file);
    std::istringstream in(file);
    std::string name, unit;
    std::size_t points;
    Vec3 first{}, last{};
    in >> name >> points >> unit >> first.x >> first.y >> first.z >> last.x >> last.y >> last.z;
    const auto cloud = read_sample(name);
    check_equal(cloud.info.declared_points, points);
    check_equal(to_string(cloud.info.unit), unit);
    REQUIRE(cloud.size() == points);
    if (points == 0) continue;
    check_near(cloud.at(0), first, 1e-6);
    check_near(cloud.at(points - 1), last, 1e-6);
  }
}

TEST_CASE("the malformed files are refused by name") {
  for (const char* name :
       {"1.2-no-points.las", "garbage_nVariableLength.las", "bad-crc.e57", "broken_size.laz",
        "no_vertex.ply", "empty.ply", "missingheader.pcd", "malformed.obj"}) {
    const auto path = data_folder() / "malformed" / name;
    check_says(refusal_of(path), path.string() + " ... expected");
  }
}

TEST_CASE("the real trajectories load, and nothing is doubted in them") {
  struct Row {
    const char* name;
    std::size_t poses, pose;
    int axis;
    double translation;
  };
  for (const Row& row : {Row{"trajectories/kitti00.txt", 4541, 1, 2, 8.586941e-01},
                         Row{"trajectories/tum_freiburg1_xyz.txt", 3000, 0, 1, 0.6305},
                         Row{"trajectories/euroc_v102.csv", 1999, 0, 0, 0.515356},
                         Row{"street/trajectory.txt", 154, 0, 2, -1.73}}) {
    const RowName name(row.name);
    std::vector<Message> remarks;
    const auto poses = read_trajectory(data_folder() / row.name, {}, &remarks);
    REQUIRE(poses.size() == row.poses);
    check_equal(poses[row.pose].translation[row.axis], row.translation);
    // EuRoC has columns of velocities and biases, which a note lists, and q = w 0.161996,
    // x 0.789985, y -0.205376, z 0.554528: R00 = 1 - 2 (y y + z z).
    const bool is_euroc = row.poses == 1999;
    if (is_euroc) check_near(poses[0].rotation[0], 0.300639, 2e-6);
    check_equal(codes_of(remarks), is_euroc ? "note unread-columns" : "");
  }
  check_equal(read_trajectory(data_folder() / "formats" / "3dtk").size(), 1);
}

TEST_CASE("the model of the street loads") {
  check_equal(read_model_points(data_folder() / "street" / "beetle.ply").size(), 46'877);
}

TEST_CASE("the street is read whole, from a file and as a stream") {
  const auto path = data_folder() / "street" / "street.las";
  const ReadCloud file = read_all(path);
  check_equal(file.size(), 4'629'906);
  CHECK((file.quanta == read_stream(path).quanta));
}

TEST_CASE("a PCD and a PTX are their LAS twins") {
  for (const auto& [name, twin, tolerance] :
       {std::tuple("autzen-utm.pcd", "autzen-utm.las", 1e-300),
        {"1.2-with-color.ptx", "1.2-with-color.las", 1e-9}}) {
    const auto cloud = read_sample(name), expected = read_sample(twin);
    REQUIRE(cloud.size() == expected.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      check_near(cloud.at(i), expected.at(i), tolerance);
    }
  }
}

TEST_CASE("an ascii PCD in commas and a scan of 3DTK are read with all their digits") {
  const auto pcd = read_sample("utm17_comma.pcd");
  REQUIRE(pcd.size() == 10);
  CHECK(pcd.positions[0] == Vec3{289814.15, 4320978.61, 170.76});
  const auto scan = read_sample("3dtk/scan000.3d");
  REQUIRE(scan.size() == 81'360);
  check_near(scan.positions[0], {0, -0.101, 0}, 1e-15);
  check_near(scan.positions[1], {0.000581712, -0.100996, -0.000662149}, 1e-15);
}

TEST_CASE("beams of a turned scanner in PTX without a return are absent") {
  const ReadCloud cloud = read_sample("complex-transform.ptx");
  check_equal(cloud.size(), 12);
  check_equal(cloud.absent.size(), 8);
  check_equal(std::ranges::count_if(cloud.positions, [](const Vec3& p) { return p.x == p.x; }), 4);
}

// The expected hash is that of what libE57Format reads.
TEST_CASE("one scan as E57 doubles, integers of 32 and of 21 bits has the same bits") {
  for (const char* name : {"bunnyDouble.e57", "bunnyInt32.e57", "cry_bunnyInt21.e57"}) {
    const ReadCloud cloud = read_sample(name);
    CHECK(cloud.info.remarks.empty());
    check_equal(hash_of(cloud.positions), 17450273413105548677U);
  }
}

TEST_CASE("a real spherical scan of E57 has every second point, and a posed one is moved") {
  const ReadCloud sphere = read_sample("cry_tiny_spherical.e57");
  REQUIRE(sphere.positions.size() == 360);
  check_equal(sphere.absent.size(), 180);
  for (std::size_t i = 0; i < 360; ++i) {
    const Vec3& p = sphere.positions[i];
    CHECK(std::isnan(p.x) == (i % 2 == 1));
    if (i % 2 == 0) check_near(std::hypot(p.x, p.y, p.z), 1, 1e-15);
  }
  REQUIRE(sphere.info.remarks.size() == 1);
  check_says(sphere.info.remarks[0].text, "180 of 360 records have no valid point");
  const ReadCloud posed = read_sample("pye57_translationWithoutRotation.e57");
  REQUIRE(posed.positions.size() == 4);
  CHECK(posed.positions.front() == Vec3{4, 5, 6});
  CHECK(posed.positions.back() == Vec3{5, 6, 6});
  REQUIRE(posed.info.remarks.size() == 1);
  check_says(posed.info.remarks[0].text, "1 scan; 1 pose is applied");
}
