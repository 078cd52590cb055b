#include "clearway/model.hpp"
#include "clearway/trajectory.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"
#include "support/test_data.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

struct Expected {
  const char* name;
  std::size_t points;
  LengthUnit unit;
  Vec3 first, last;  ///< in metres, compared within 1e-6 of a unit
};

Vec3 position_of(const ReadCloud& cloud, std::size_t index) {
  if (cloud.quanta.empty()) return cloud.positions[index];
  const auto& q = cloud.quanta[index];
  return position(*cloud.info.quantisation, q[0], q[1], q[2]);
}

}  // namespace

TEST_CASE(
    "every LAS, PLY and text file loads with its header's count, unit, first and last point") {
  static const Expected kFiles[] = {
      {"1.0_0.las",
       1,
       LengthUnit::kMetre,
       {470692.44, 4602888.9, 16.0},
       {470692.44, 4602888.9, 16.0}},
      {"1.1_1.las",
       1,
       LengthUnit::kMetre,
       {470692.44, 4602888.9, 16.0},
       {470692.44, 4602888.9, 16.0}},
      {"1.2-with-color.las",
       1065,
       LengthUnit::kUnknown,
       {637012.24, 849028.31, 431.66},
       {637342.85, 853240.32, 423.92}},
      {"1.2_3.las",
       1,
       LengthUnit::kMetre,
       {470692.44, 4602888.9, 16.0},
       {470692.44, 4602888.9, 16.0}},
      {"1_4_w_evlr.las",
       1000,
       LengthUnit::kUsSurveyFoot,
       {1694510.386934684, 1816497.966263977, 5598.359612815},
       {1694291.636332656, 1816493.066230585, 5597.089652538}},
      {"autzen-utm.las",
       1065,
       LengthUnit::kMetre,
       {494428.61, 4877455.58, 131.57},
       {494490.24, 4878741.67, 129.21}},
      {"autzen_trim_7.las",
       110000,
       LengthUnit::kFoot,
       {637177.98, 849393.95, 411.19},
       {636037.88, 849336.94, 423.2}},
      {"epsg_4326.las",
       5380,
       LengthUnit::kDegrees,
       {-94.6639387, 31.0367341, 47.8700002},
       {-94.6803588, 31.0473291, 52.6800002}},
      {"extrabytes.las",
       1065,
       LengthUnit::kUnknown,
       {637012.24, 849028.31, 431.66},
       {637342.85, 853240.32, 423.92}},
      {"no-points-1.3.las", 0, LengthUnit::kUnknown, {0, 0, 0}, {0, 0, 0}},
      {"rand1_6.las",
       50000,
       LengthUnit::kUnknown,
       {1351727964.0, 581869302.0, 1742863086.0},
       {92095808.0, -1752414158.0, 1157661265.0}},
      {"simple1_3.las",
       999,
       LengthUnit::kMetre,  // by the key of geodetic systems
       {-234935.841, 5800843.145, 265.094},
       {-235433.76, 5800946.08, 273.729}},
      {"simple1_4.las", 22600, LengthUnit::kDegrees, {1.0, 1.0, 100.0}, {226.0, 100.0, 185.0}},
      {"test1_4.las",
       1000,
       LengthUnit::kUsSurveyFoot,
       {1694510.386934684, 1816497.966263977, 5598.359612815},
       {1694291.636332656, 1816493.066230585, 5597.089652538}},
      {"simple_text.ply", 3, LengthUnit::kUnknown, {-1, 0, 0}, {1, 0, 0}},
      {"text_extradim.ply",
       1,
       LengthUnit::kUnknown,
       {-2.64944, -13.0955, 0.00640115},
       {-2.64944, -13.0955, 0.00640115}},
      {"autzen.pts",
       10,
       LengthUnit::kUnknown,
       {636110.300003, 849345.050003, 512.139999},
       {636125.859990, 848971.070013, 428.050003}},
      {"simple_binary.ply", 3, LengthUnit::kUnknown, {-1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}};
  for (const Expected& file : kFiles) {
    INFO(file.name);
    const auto cloud = read_all(data_folder() / "formats" / file.name);
    check_equal(cloud.size(), file.points);
    CHECK(cloud.info.declared_points == file.points);
    CHECK(cloud.info.unit == file.unit);
    if (cloud.size() != file.points || file.points == 0) continue;
    for (int k = 0; k < 3; ++k) {
      CHECK(position_of(cloud, 0)[k] == Approx(file.first[k]).margin(1e-6));
      CHECK(position_of(cloud, file.points - 1)[k] == Approx(file.last[k]).margin(1e-6));
    }
  }
}

TEST_CASE("the malformed files are refused by name") {
  for (const char* name :
       {"1.2-no-points.las", "garbage_nVariableLength.las", "bad-crc.e57", "broken_size.laz",
        "no_vertex.ply", "empty.ply", "missingheader.pcd", "malformed.obj"}) {
    INFO(name);
    const auto path = data_folder() / "malformed" / name;
    check_says(refusal_of(path), std::string(path.string()) + " ... expected");
  }
}

TEST_CASE("the real trajectories load") {
  const auto read = [](const char* name) {
    return read_trajectory(data_folder() / name, TrajectoryOptions{});
  };
  const auto kitti = read("trajectories/kitti00.txt");
  REQUIRE(kitti.size() == 4541);
  check_equal(kitti[1].translation[2], 8.586941e-01);
  const auto tum = read("trajectories/tum_freiburg1_xyz.txt");
  REQUIRE(tum.size() == 3000);
  check_equal(tum[0].translation[1], 0.6305);
  const auto euroc = read("trajectories/euroc_v102.csv");
  REQUIRE(euroc.size() == 1999);
  check_equal(euroc[0].translation[0], 0.515356);
  // q = w 0.161996, x 0.789985, y -0.205376, z 0.554528: R00 = 1 - 2 (y y + z z).
  CHECK(euroc[0].rotation[0] == Approx(0.300639).margin(2e-6));
  const auto street = read("street/trajectory.txt");
  REQUIRE(street.size() == 154);
  check_equal(street[0].translation[2], -1.73);
}

TEST_CASE("nothing is doubted in the real trajectories") {
  for (const char* name : {"trajectories/kitti00.txt", "trajectories/tum_freiburg1_xyz.txt",
                           "trajectories/euroc_v102.csv", "street/trajectory.txt"}) {
    INFO(name);
    std::vector<Message> remarks;
    read_trajectory(data_folder() / name, {}, &remarks);
    // EuRoC has columns of velocities and biases, which a note lists.
    std::erase_if(remarks, [](const Message& remark) {
      return remark.severity == Message::Severity::kNote && remark.code == "unread-columns";
    });
    CHECK(remarks.empty());
  }
}

TEST_CASE("the poses of a 3DTK folder load in the order of their numbers") {
  check_equal(read_trajectory(data_folder() / "formats" / "3dtk").size(), 1);
}

TEST_CASE("the model of the street loads") {
  const auto model = read_model_points(data_folder() / "street" / "beetle.ply");
  check_equal(model.size(), 46'877);
}

TEST_CASE("the street is read whole, from a file and as a stream") {
  const auto path = data_folder() / "street" / "street.las";
  std::uint64_t sums[2] = {0, 0};
  for (int pass = 0; pass < 2; ++pass) {
    const auto reader = pass == 0 ? open_point_file(path)
                                  : open_las_stream(File::open_for_reading(path),
                                                    std::filesystem::temp_directory_path());
    PointBatch batch;
    std::size_t count = 0;
    while (reader->read(batch)) {
      count += batch.size();
      for (const auto& q : batch.quanta) {
        for (const std::int32_t c : q) sums[pass] = sums[pass] * 31 + static_cast<std::uint32_t>(c);
      }
    }
    check_equal(count, 4'629'906);
  }
  CHECK(sums[0] == sums[1]);
}
