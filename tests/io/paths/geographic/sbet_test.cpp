#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "clearway/error.hpp"
#include "clearway/trajectory.hpp"
#include "support/attitudes.hpp"
#include "support/bytes/sbet_bytes.hpp"
#include "support/catch.hpp"
#include "support/made_path.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

struct Read : MadePath {
  const Message* find(const std::string& code) const {
    const auto found = std::ranges::find(remarks, code, &Message::code);
    return found == remarks.end() ? nullptr : &*found;
  }
};

const TrajectoryOptions kUtm32{.crs = "EPSG:32632"};

Read read_sbet(const std::string& bytes, const TrajectoryOptions& options = kUtm32,
               const std::string& name = "path.sbet") {
  return {read_path(bytes, options, name)};
}

void check_sbet_refused(const std::string& bytes, const std::string& words,
                        const TrajectoryOptions& options = kUtm32,
                        const std::string& name = "path.sbet") {
  check_path_refused(bytes, words, options, name);
}

const SbetRecord kRecord{.latitude = 0.85, .longitude = 0.19, .altitude = 512.25};
/// The angle there from true north clockwise to the map's north, by the classical series.
constexpr double kConvergence = 0.0247363529486;

}  // namespace

TEST_CASE("SBET: positions in UTM, as Krueger's series has them") {
  const SbetRecord b{.latitude = 0.8500001, .longitude = 0.1899998, .altitude = -3};
  const Read found = read_sbet(kRecord.bytes() + b.bytes());
  REQUIRE(found.poses.size() == 2);
  check_near(found.poses[0].position(), {638780.875627006, 5395980.584558245, 512.25}, 1e-5);
  check_near(found.poses[1].position(), {638780.016778649, 5395981.200551745, -3}, 1e-5);
  check_equal(found.poses[0].translation[2], 512.25);
  check_equal(found.codes(), "note map-projection, ellipsoidal-heights, note model-frame");
  check_says(found.text(), "UTM zone 32N");
}

TEST_CASE("SBET: attitude by wander angle and meridian convergence") {
  SbetRecord record = kRecord;
  for (int i = 0; i < 40; ++i) {
    record.roll = 0.3 * std::sin(i);
    record.pitch = 0.2 * std::cos(3.0 * i);
    record.heading = std::remainder(0.7 * i, 2 * std::numbers::pi);
    record.wander = 0.4 * std::cos(i);
    const Read found = read_sbet(record.bytes());
    const double on_map = record.heading - record.wander - kConvergence;
    const Rotation expected = navigation_rotation(record.roll, record.pitch, on_map);
    CHECK(greatest_difference(expected, found.poses.at(0).rotation) < 1e-7);
  }
}

TEST_CASE("SBET: the CRS of the environment serves where none is named") {
  const std::string bytes = SbetRecord().bytes();
  check_sbet_refused(bytes, "expected the projected coordinate reference system", {});
  const std::string wkt =
      R"(PROJCS["local",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["central_meridian",9],PARAMETER["scale_factor",0.9996],PARAMETER["false_easting",500000],UNIT["metre",1])";
  const Read found = read_sbet(bytes, {.default_crs = wkt + "]"});
  check_near(found.poses.at(0).position(), {471884.761371455, 5712869.664172725, 107.5}, 1e-5);
  check_says(found.find("map-projection")->text, "as the environment");
  const std::string files = wkt + ",EXTENSION[\"PROJ4\",\"+proj=utm +nadgrids=/etc/passwd\"]]";
  check_sbet_refused(bytes, "not opened", {.default_crs = files});
  check_sbet_refused(bytes, "does not know", {.default_crs = "hello"});
  check_sbet_refused(bytes, "environment", {.default_crs = "GEOGCS[\"a\"]"});
  const std::string proj = "+proj=utm +zone=32 +datum=WGS84";
  CHECK(read_sbet(bytes, {.default_crs = proj}).poses == read_sbet(bytes).poses);
  CHECK(read_sbet(bytes, {.crs = proj}).poses == read_sbet(bytes).poses);
  for (const char* crs : {"EPSG:0", "hello", "EPSG:4326", "EPSG:4979", "EPSG:4978", "+proj=utm"}) {
    const RowName name(crs);
    CHECK_THROWS_AS(read_sbet(bytes, {.crs = crs}), UsageError);
  }
  for (TrajectoryOptions misuse :
       {TrajectoryOptions{.datum = "hello"}, TrajectoryOptions{.angle_unit = AngleUnit::kDegrees},
        TrajectoryOptions{.metres_per_unit = 0.001}}) {
    misuse.crs = kUtm32.crs;
    CHECK_THROWS_AS(read_sbet(bytes, misuse), UsageError);
  }
}

TEST_CASE("heights, units and datum of a CRS are said") {
  const std::string california =
      SbetRecord{.latitude = 0.57, .longitude = -2.04, .altitude = 30.48}.bytes();
  const std::string germany = SbetRecord().bytes();
  const auto severity = [](const Read& found, const char* code) {
    const Message* const message = found.find(code);
    return message == nullptr                              ? "none"
           : message->severity == Message::Severity::kNote ? "note"
                                                           : "warning";
  };
  const Read feet = read_sbet(california, {.crs = "EPSG:2230"});
  CHECK(feet.poses.at(0).translation[2] == Approx(30.48 * 3937 / 1200));
  CHECK(feet.find("map-unit"));
  check_equal(severity(feet, "datum-accuracy"), "warning");
  const Read own = read_sbet(california, {.crs = "EPSG:6425+ellipsoidal", .datum = "EPSG:6319"});
  check_equal(severity(own, "datum-accuracy"), "none");
  check_equal(severity(own, "ellipsoidal-heights"), "none");
  check_equal(severity(read_sbet(germany, {.crs = "EPSG:25832"}), "datum-accuracy"), "note");
  check_equal(severity(read_sbet(germany, {.crs = "EPSG:3857"}), "map-scale"), "warning");
  // This map nearly keeps lengths along the meridian, but not along the parallel at latitude 0.9.
  const double sine = std::sin(0.9), w2 = 1 - 6.69437999014e-3 * sine * sine;
  const double along = std::sqrt(w2) / std::cos(0.9);
  const double across = std::pow(w2, 1.5) / (1 - 6.69437999014e-3);
  const Read cylinder = read_sbet(germany, {.crs = "EPSG:4087"});
  REQUIRE(cylinder.find("map-scale"));
  const auto& numbers = cylinder.find("map-scale")->numbers;
  CHECK(numbers.at(1).second == Approx(along).epsilon(1e-6));
  CHECK(numbers.at(2).second == Approx(std::sqrt(along * across)).epsilon(1e-6));
}

TEST_CASE("SBET: degrees, cut files and numbers that are none are refused") {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::pair<SbetRecord, const char*> rows[] = {
      {{.latitude = 51.5}, "byte 136 ... record 1 ... radians, not degrees"},
      {{.heading = 174.5}, "heading ... not degrees"},
      {{.pitch = kNan}, "pitch nan"},
      {{.altitude = std::numeric_limits<double>::infinity()}, "altitude inf"},
      {{.latitude = 0, .longitude = 0}, "are 0"},
      {{.time = kNan}, "time"}};
  for (const auto& [record, words] : rows) {
    check_sbet_refused(SbetRecord().bytes() + record.bytes(), words);
  }
  const std::string two = SbetRecord().bytes() + SbetRecord().bytes();
  CHECK(read_sbet("").poses.empty());
  for (std::size_t size = 1; size < two.size(); ++size) {
    CAPTURE(size);
    if (size != 136) check_sbet_refused(two.substr(0, size), "behind the last whole record of 136");
  }
}

TEST_CASE("SBET is known by its ending, or by .out and its bytes") {
  const std::string bytes = SbetRecord().bytes();
  check_equal(read_sbet(bytes, kUtm32, "path.out").poses.size(), 1);
  check_equal(read_sbet(bytes, kUtm32, "path.SBET").poses.size(), 1);
  check_equal(read_sbet("1 0 0 0 0 1 0 0 0 0 1 0\n", {}, "path.out").poses.size(), 1);
  check_sbet_refused(bytes, "may be an SBET", kUtm32, "path.bin");
  TrajectoryOptions named = kUtm32;
  named.format = TrajectoryFormat::kSbet;
  check_equal(read_sbet(bytes, named, "path.bin").poses.size(), 1);
  const SbetRecord early{.time = 10}, late{.time = 20};
  CHECK(read_sbet(early.bytes() + late.bytes()).find("time-order") == nullptr);
  CHECK(read_sbet(late.bytes() + early.bytes()).find("time-order"));
}
