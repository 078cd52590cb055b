// The inputs of an environment: its files in order, points that are not finite, units.
#include <sys/stat.h>

#include <cmath>

#include "read_environment.hpp"
#include "support/bytes/las_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::string las_with_wkt(const std::string& wkt) {
  LasBytes las;
  las.minor = 4;
  las.format = 6;
  las.global_encoding = 16;
  las.vlrs = {{"LASF_Projection", 2112, wkt}};
  return las.build();
}

const std::string kMetreWkt = R"(LOCAL_CS["m",UNIT["metre",1]])";
const std::string kFootWkt = R"(LOCAL_CS["f",UNIT["US survey foot",0.3048006096012192]])";
const std::string kDegreeWkt =
    R"(GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],)"
    R"(PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]])";

}  // namespace

TEST_CASE("inputs follow each other as given, a folder's in byte order of their names") {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "scans");
  const auto add = [&](const std::string& name, std::int32_t x) {
    write_las(folder / name, std::vector<Quantum>{{x, 0, 0}});
  };
  add("scans/b.las", 3);
  add("scans/B.las", 1);
  add("scans/a10.las", 2);
  add("z.las", 0);
  add("a.las", 4);
  const Environment environment =
      read_environment({folder / "z.las", folder / "scans", folder / "a.las"});
  REQUIRE(environment.points.size() == 5);
  for (std::int32_t i = 0; i < 5; ++i) {
    CHECK(environment.points[static_cast<std::size_t>(i)] ==
          StoredPoint{static_cast<std::uint64_t>(i), {i, 0, 0}});
  }
}

TEST_CASE("points that are not finite are counted and keep their index") {
  const ScratchFolder folder;
  const std::vector<Vec3> points{{kNaN, 0, 0},       {1, 1, 1}, {0, kInfinity, 0}, {2, 2, 2},
                                 {0, 0, -kInfinity}, {3, 3, 3}, {kNaN, kNaN, kNaN}};
  write_ply(folder / "a.ply", points);
  write_ply(folder / "none.ply", std::vector<Vec3>(3, {kNaN, 0, 0}));
  const Environment environment =
      read_environment({folder / "a.ply", folder / "none.ply", folder / "a.ply"});
  check_equal(environment.non_finite_points, 11);
  check_equal(environment.input_points, 17);
  std::vector<std::uint64_t> sources;
  for (const StoredPoint& p : environment.points) sources.push_back(p.source);
  check_equal(sources, {1, 3, 5, 11, 13, 15});
}

TEST_CASE("points of batches that start, end and consist of non-finite ones keep their index") {
  const ScratchFolder folder;
  std::vector<Vec3> points(3 * PointReader::kBatchPoints + 5, {1, 2, 3});
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t batch = i / PointReader::kBatchPoints;
    points[i].x = static_cast<double>(i % 1000);
    if (batch == 1 || i % PointReader::kBatchPoints < 3 || i % 7 == 0) points[i].z = kNaN;
  }
  write_ply(folder / "a.ply", points);
  const Environment environment = read_environment({folder / "a.ply"});
  std::size_t next = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::isnan(points[i].z)) continue;
    REQUIRE(next < environment.points.size());
    REQUIRE(environment.points[next].source == i);
    REQUIRE(environment.points[next].q[0] == 1'000'000 * static_cast<std::int32_t>(points[i].x));
    ++next;
  }
  CHECK(next == environment.points.size());
}

TEST_CASE("no point, and none that is finite, make an empty environment") {
  const ScratchFolder folder;
  write_ply(folder / "a.ply", std::vector<Vec3>(2, {kNaN, 0, 0}));
  CHECK(read_environment({folder / "a.ply"}).points.empty());
  write_ply(folder / "b.ply", std::vector<Vec3>{});
  CHECK(read_environment({folder / "b.ply"}).points.empty());
}

TEST_CASE("degrees are refused, unless they are to be taken as they are") {
  const ScratchFolder folder;
  put_bytes(folder / "a.las", las_with_wkt(kDegreeWkt));
  check_says(refusal({folder / "a.las"}), "degrees");
  CHECK(refused({folder / "a.las"})->remedy() == Remedy::kIgnoreCrs);
  check_equal(read_environment({folder / "a.las"}, {.ignore_crs = true}).points.size(), 3);
}

TEST_CASE("units that cannot be taken as they are are refused, unless that is accepted") {
  const ScratchFolder folder;
  put_bytes(folder / "km.las", las_with_wkt("LOCAL_CS[\"far\",UNIT[\"kilometre\",1000]]"));
  const auto open = [&](bool ignore) {
    ConversionOptions options = conversion_of({folder / "km.las"}, folder / "out.h5");
    options.ignore_crs = ignore;
    return convert_quietly(options);
  };
  check_refused([&] { return open(false); }, "its unit is 1000 m");
  CHECK(open(true).points > 0);
}

TEST_CASE("feet are reported, other units than the first file's refused") {
  const ScratchFolder folder;
  put_bytes(folder / "feet.las", las_with_wkt(kFootWkt));
  put_bytes(folder / "metres.las", las_with_wkt(kMetreWkt));
  const Environment feet = read_environment({folder / "feet.las"});
  CHECK(feet.unit == LengthUnit::kUsSurveyFoot);
  REQUIRE(feet.warnings.size() == 1);
  check_says(feet.warnings[0].text, "feet");
  CHECK(read_environment({folder / "metres.las"}).warnings.empty());
  check_says(refusal({folder / "metres.las", folder / "feet.las"}), "unit of length");
  check_equal(read_environment({folder / "metres.las", folder / "feet.las"}, {.ignore_crs = true})
                  .points.size(),
              6);
}

TEST_CASE("lengths without a unit go with metres, but not with feet") {
  const ScratchFolder folder;
  put_bytes(folder / "none.xyz", "1 2 3\n");
  put_bytes(folder / "metres.xyz", "X [m],Y [m],Z [m]\n1,2,3\n");
  put_bytes(folder / "feet.xyz", "X [ft],Y [ft],Z [ft]\n1,2,3\n");
  for (const auto& inputs : {std::vector{folder / "none.xyz", folder / "metres.xyz"},
                             std::vector{folder / "metres.xyz", folder / "none.xyz"}}) {
    const Environment environment = read_environment(inputs);
    CHECK(environment.unit == LengthUnit::kMetre);
    CHECK(environment.warnings.empty());
  }
  check_says(refusal({folder / "none.xyz", folder / "feet.xyz"}), "unit of length");
  const Environment feet = read_environment({folder / "feet.xyz"});
  REQUIRE(feet.warnings.size() == 1);
  check_equal(feet.warnings[0].code, "feet");
}

TEST_CASE("files that say nothing of their unit and system go with metres, not with feet") {
  const ScratchFolder folder;
  put_bytes(folder / "feet.las", las_with_wkt(kFootWkt));
  put_bytes(folder / "metres.las", las_with_wkt(kMetreWkt));
  put_bytes(folder / "none.xyz", "100 -200 0\n");
  for (const bool last : {false, true}) {
    const auto first = folder / (last ? "none.xyz" : "metres.las");
    const Environment mixed =
        read_environment({first, folder / (last ? "metres.las" : "none.xyz")});
    CHECK(mixed.unit == LengthUnit::kMetre);
    check_equal(mixed.points.size(), 4);
    const auto& notes = mixed.warnings;
    const auto noted = std::find_if(notes.begin(), notes.end(),
                                    [](const Message& m) { return m.code == "no-crs"; });
    REQUIRE(noted != notes.end());
    CHECK(noted->severity == Message::Severity::kNote);
    check_says(noted->text, "1 of 2 files ... metres.las");
  }
  check_says(refusal({folder / "feet.las", folder / "none.xyz"}),
             "none.xyz ... unknown ... feet.las");
  check_says(refusal({folder / "none.xyz", folder / "feet.las"}), "none.xyz");
}

TEST_CASE("a pipe given as a file is refused with advice") {
  const ScratchFolder folder;
  const auto pipe = folder / "pipe.las";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  check_says(refusal({pipe}), "standard input");
}

TEST_CASE("standard input goes with nothing else") {
  NoProgress progress;
  CHECK_THROWS_AS(EnvironmentSource({"-", "a.las"}, {}, progress), UsageError);
}
