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
  Inputs inputs;
  std::filesystem::create_directory(inputs.folder / "scans");
  int x = 0;
  std::vector<Quantum> expected;
  for (const char* name : {"z.las", "scans/B.las", "scans/a10.las", "scans/b.las", "a.las"}) {
    expected.push_back({x++, 0, 0});
    write_las(inputs.folder / name, std::vector<Quantum>{expected.back()});
  }
  inputs.options.inputs = {inputs.folder / "z.las", inputs.folder / "scans",
                           inputs.folder / "a.las"};
  const Environment environment = inputs.read();
  CHECK(environment.quanta() == expected);
  check_equal(environment.points[4].source, 4);
}

TEST_CASE("points that are not finite are counted and keep their index") {
  Inputs inputs;
  inputs.add_ply("a.ply", std::vector<Vec3>{{kNaN, 0, 0},
                                            {1, 1, 1},
                                            {0, kInfinity, 0},
                                            {2, 2, 2},
                                            {0, 0, -kInfinity},
                                            {3, 3, 3},
                                            {kNaN, kNaN, kNaN}});
  inputs.add_ply("none.ply", std::vector<Vec3>(3, {kNaN, 0, 0}));
  inputs.options.inputs.push_back(inputs.folder / "a.ply");
  const Environment environment = inputs.read();
  check_equal(environment.non_finite_points, 11);
  check_equal(environment.input_points, 17);
  std::vector<std::uint64_t> sources;
  for (const StoredPoint& p : environment.points) sources.push_back(p.source);
  check_equal(sources, {1, 3, 5, 11, 13, 15});
  inputs.options.inputs = {inputs.folder / "none.ply"};
  CHECK(inputs.read().points.empty());
}

TEST_CASE("points of batches that start, end and consist of non-finite ones keep their index") {
  std::vector<Vec3> points(3 * PointReader::kBatchPoints + 5, {1, 2, 3});
  std::vector<StoredPoint> expected;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t batch = i / PointReader::kBatchPoints;
    const auto x = static_cast<std::int32_t>(i % 1000);
    points[i].x = x;
    if (batch == 1 || i % PointReader::kBatchPoints < 3 || i % 7 == 0) {
      points[i].z = kNaN;
    } else {
      expected.push_back({i, {1'000'000 * x, 0, 0}});
    }
  }
  Inputs inputs;
  inputs.add_ply("a.ply", points);
  const Environment environment = inputs.read();
  CHECK(std::ranges::equal(environment.points, expected, [](const auto& a, const auto& b) {
    return a.source == b.source && a.q[0] == b.q[0];
  }));
}

TEST_CASE("units that cannot be taken as they are are refused, unless that is accepted") {
  Inputs inputs;
  inputs.add("a.las", las_with_wkt(kDegreeWkt));
  check_says(inputs.refusal(), "degrees");
  CHECK(inputs.refused().remedy() == Remedy::kIgnoreCrs);
  check_equal(inputs.read({.ignore_crs = true}).points.size(), 3);
  inputs.add("a.las", las_with_wkt("LOCAL_CS[\"far\",UNIT[\"kilometre\",1000]]"));
  check_says(conversion_refusal<Error>(inputs.options), "its unit is 1000 m");
  inputs.options.ignore_crs = true;
  check_equal(inputs.convert().points, 3);
}

TEST_CASE("lengths in metres, in feet and without a unit go together where they mean the same") {
  Inputs inputs;
  inputs.add("feet.las", las_with_wkt(kFootWkt));
  inputs.add("metres.las", las_with_wkt(kMetreWkt));
  inputs.add("none.xyz", "100 -200 0\n");
  inputs.add("metres.xyz", "X [m],Y [m],Z [m]\n1,2,3\n");
  inputs.add("feet.xyz", "X [ft],Y [ft],Z [ft]\n1,2,3\n");
  const auto give = [&](const std::vector<std::string>& files) {
    inputs.options.inputs.clear();
    for (const std::string& file : files) inputs.options.inputs.push_back(inputs.folder / file);
  };
  const auto check = [&](const std::vector<std::string>& files, LengthUnit unit, const char* codes,
                         const char* words = "") {
    const RowName name(files.front() + " " + files.back());
    give(files);
    const Environment environment = inputs.read();
    CHECK(environment.unit == unit);
    check_equal(codes_of(environment.warnings), codes);
    check_says(environment.warnings.empty() ? "" : environment.warnings[0].text, words);
  };
  const auto check_apart = [&](const std::string& first, const std::string& second,
                               const char* words) {
    give({first, second});
    check_says(inputs.refusal(), words);
    CHECK(inputs.read({.ignore_crs = true}).points.size() >= 2);
  };
  check({"feet.las"}, LengthUnit::kUsSurveyFoot, "feet", "feet");
  check({"feet.xyz"}, LengthUnit::kFoot, "feet", "feet");
  check({"metres.las"}, LengthUnit::kMetre, "");
  check({"none.xyz", "metres.xyz"}, LengthUnit::kMetre, "");
  check({"metres.xyz", "none.xyz"}, LengthUnit::kMetre, "");
  for (const bool turned : {false, true}) {
    std::vector<std::string> mixed{"metres.las", "none.xyz"};
    if (turned) std::swap(mixed[0], mixed[1]);
    check(mixed, LengthUnit::kMetre, "note no-crs, floating-point-rounded",
          "1 of 2 files ... metres.las");
  }
  check_apart("metres.las", "feet.las", "unit of length");
  check_apart("none.xyz", "feet.xyz", "unit of length");
  check_apart("feet.las", "none.xyz", "none.xyz ... unknown ... feet.las");
  check_apart("none.xyz", "feet.las", "none.xyz");
}

TEST_CASE("standard input goes with nothing else, and a pipe given as a file is refused") {
  NoProgress progress;
  const ConversionOptions both{{}, {"-", "a.las"}, "a.h5"};
  CHECK_THROWS_AS(EnvironmentSource(both, progress), UsageError);
  Inputs inputs;
  const auto pipe = inputs.folder / "pipe.las";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  inputs.options.inputs = {pipe};
  check_says(inputs.refusal(), "standard input");
}
