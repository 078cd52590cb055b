#include <cstring>

#include "clearway/error.hpp"
#include "io/result/export/export_result.hpp"
#include "io/scans/point_reader.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

ResultHeader header_in_millimetres() {
  ResultHeader header = sample_header(false);
  header.quantisation = {{0.001, 0.001, 0.001}, {0, 0, 0}};
  header.poses = 3;
  return header;
}

struct Tables {
  Tables() {
    header.clearance = 0.75;
    header.profile = 0.5;
    const Vec3 a = position(header.quantisation, 14780, -2, 3);
    const Vec3 b = position(header.quantisation, 5, 6, -7);
    const double none = std::numeric_limits<double>::quiet_NaN();
    profile = {{{0.25, std::numeric_limits<double>::infinity(), 0.1},
                {9, Profile::kNoPoint, 3},
                {b, {none, none, none}, a},
                {0, 1.5, 2.25}}};
    write_result(folder / "a.h5", header, {}, 1000, {{3, 9}, {a, b}, {0.5, 0.1}, {2, 0}}, profile);
  }
  std::string clearances(const std::string& name) const {
    NoProgress progress;
    export_clearances(ResultReader(folder / "a.h5"), folder / name, false, progress);
    return bytes_of(folder / name);
  }
  std::string profile_text(const PoseLabels& labels, double chainage_start = 0) const {
    NoProgress progress;
    export_profile(ResultReader(folder / "a.h5"), labels, chainage_start, folder / "p.csv", true,
                   progress);
    return bytes_of(folder / "p.csv");
  }

  ScratchFolder folder;
  ResultHeader header = header_in_millimetres();
  ProfileRows profile;
};

}  // namespace

TEST_CASE("clearances are exported with their places") {
  const Tables tables;
  CHECK(tables.clearances("a.csv") ==
        "source,x,y,z,distance,pose\n3,14.78,-0.002,0.003,0.5,2\n9,0.005,0.006,-0.007,0.1,0\n");
  check_equal(tables.clearances("a.xyz"), "14.78 -0.002 0.003 0.5 2\n0.005 0.006 -0.007 0.1 0\n");
  check_says(tables.clearances("a.ply"),
             "property double z\nproperty double distance\nproperty uint pose\nend_header");
  const std::string las = tables.clearances("a.las");
  check_says(las, "distance ... pose that has the distance");
  const auto reader = open_point_file(tables.folder / "a.las");
  PointBatch batch;
  REQUIRE(reader->read(batch));
  CHECK(batch.quanta[0] == std::array<std::int32_t, 3>{14780, -2, 3});
  double distance = 0;
  std::memcpy(&distance, las.data() + las.size() - 12, sizeof distance);
  check_equal(distance, 0.1);
}

TEST_CASE("a result without clearances or profile is refused with the remedy") {
  const ScratchFolder folder;
  write_result(folder / "b.h5", sample_header(false), {});
  const ResultReader result(folder / "b.h5");
  NoProgress progress;
  CHECK_THROWS_AS(export_clearances(result, folder / "b.csv", false, progress), UsageError);
  check_refused([&] { return export_profile(result, {}, 0, folder / "b.csv", false, progress); },
                "has no profile");
}

TEST_CASE("a profile is exported as CSV, without values where there is no point") {
  const Tables tables;
  CHECK(tables.profile_text({}) ==
        "pose,chainage,distance,source,x,y,z\n0,0,0.25,9,0.005,0.006,-0.007\n1,1.5,,,,,\n"
        "2,2.25,0.1,3,14.78,-0.002,0.003\n");
  CHECK(tables.profile_text({}, 1000.5) ==
        "pose,chainage,distance,source,x,y,z\n0,1000.5,0.25,9,0.005,0.006,-0.007\n"
        "1,1002,,,,,\n2,1002.75,0.1,3,14.78,-0.002,0.003\n");
  NoProgress progress;
  CHECK_THROWS_AS(export_profile(ResultReader(tables.folder / "a.h5"), {}, 0,
                                 tables.folder / "p.las", true, progress),
                  UsageError);
}

TEST_CASE("a profile is exported with times and names of its poses") {
  const Tables tables;
  CHECK(tables.profile_text({{1e9 + 0.1, 2, 3.5}, {"=1+1", "b, \"c\"", "-3"}}) ==
        "pose,time,name,chainage,distance,source,x,y,z\n"
        "0,1000000000.1,\"'=1+1\",0,0.25,9,0.005,0.006,-0.007\n"
        "1,2,\"b, \"\"c\"\"\",1.5,,,,,\n"
        "2,3.5,-3,2.25,0.1,3,14.78,-0.002,0.003\n");
}
