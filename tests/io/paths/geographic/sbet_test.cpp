#include <cmath>
#include <limits>
#include <numbers>

#include "clearway/error.hpp"
#include "clearway/trajectory.hpp"
#include "support/attitudes.hpp"
#include "support/bytes/sbet_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr double kPi = std::numbers::pi;

struct Read {
  std::vector<Pose> poses;
  std::vector<Message> remarks;

  const Message* find(const std::string& code) const {
    for (const Message& remark : remarks) {
      if (remark.code == code) return &remark;
    }
    return nullptr;
  }
};

Read read(const std::string& bytes, const TrajectoryOptions& options,
          const std::string& name = "path.sbet") {
  const ScratchFolder scratch;
  Read result;
  result.poses = read_trajectory(scratch.write(name, bytes), options, &result.remarks);
  return result;
}

/// The message of the InputError with which the bytes are refused; fails for any other end.
std::string refusal_of_sbet(const std::string& bytes, const TrajectoryOptions& options,
                            const std::string& name = "path.sbet") {
  try {
    read(bytes, options, name);
  } catch (const InputError& error) {
    check_says(error.what(), name);
    return error.what();
  }
  FAIL("read");
  return {};
}

/// UTM on WGS 84 by Krueger's series to n^4, which is exact to below a micrometre.
struct Utm {
  double easting, northing;
};

Utm utm(double latitude, double longitude, int zone) {
  constexpr double f = 1 / 298.257223563;
  constexpr double n = f / (2 - f);
  constexpr double kRadius = 6378137 / (1 + n) * (1 + n * n / 4 + n * n * n * n / 64);
  constexpr double kAlpha[] = {
      n / 2 - 2 * n * n / 3 + 5 * n * n * n / 16 + 41 * n * n * n * n / 180,
      13 * n * n / 48 - 3 * n * n * n / 5 + 557 * n * n * n * n / 1440,
      61 * n * n * n / 240 - 103 * n * n * n * n / 140, 49561 * n * n * n * n / 161280};
  const double l = longitude - (6 * zone - 183) * kPi / 180;
  const double c = 2 * std::sqrt(n) / (1 + n);
  const double s = std::sin(latitude);
  const double t = std::sinh(std::atanh(s) - c * std::atanh(c * s));
  const double xi = std::atan2(t, std::cos(l));
  const double eta = std::atanh(std::sin(l) / std::sqrt(1 + t * t));
  double east = eta;
  double north = xi;
  for (int j = 1; j <= 4; ++j) {
    east += kAlpha[j - 1] * std::cos(2 * j * xi) * std::sinh(2 * j * eta);
    north += kAlpha[j - 1] * std::sin(2 * j * xi) * std::cosh(2 * j * eta);
  }
  return {500000 + 0.9996 * kRadius * east, 0.9996 * kRadius * north};
}

/// The angle from true north clockwise to the map's north, by the classical series.
double convergence(double latitude, double longitude, int zone) {
  const double l = longitude - (6 * zone - 183) * kPi / 180;
  const double cos2 = std::cos(latitude) * std::cos(latitude);
  const double eta2 = 6.73949674228e-3 * cos2;
  return l * std::sin(latitude) * (1 + l * l * cos2 / 3 * (1 + 3 * eta2 + 2 * eta2 * eta2));
}

}  // namespace

TEST_CASE("SBET: positions in UTM, as Krueger's series has them") {
  const SbetRecord a{.latitude = 0.85, .longitude = 0.19, .altitude = 512.25};
  const SbetRecord b{.latitude = 0.8500001, .longitude = 0.1899998, .altitude = -3};
  const Read found = read(a.bytes() + b.bytes(), {.crs = "EPSG:32632"});
  REQUIRE(found.poses.size() == 2);
  for (int i = 0; i < 2; ++i) {
    const SbetRecord& record = i == 0 ? a : b;
    const Utm expected = utm(record.latitude, record.longitude, 32);
    check_near(found.poses[i].translation[0], expected.easting, 1e-5);
    check_near(found.poses[i].translation[1], expected.northing, 1e-5);
    CHECK(found.poses[i].translation[2] == record.altitude);
  }
  REQUIRE(found.find("map-projection"));
  check_says(found.find("map-projection")->text, "UTM zone 32N");
  REQUIRE(found.find("ellipsoidal-heights"));
  CHECK(found.find("ellipsoidal-heights")->severity == Message::Severity::kWarning);
  CHECK(found.find("datum-accuracy") == nullptr);
}

TEST_CASE("SBET: attitude by wander angle and meridian convergence") {
  SbetRecord record{.latitude = 0.85, .longitude = 0.19};
  for (int i = 0; i < 40; ++i) {
    record.roll = 0.3 * std::sin(i);
    record.pitch = 0.2 * std::cos(3.0 * i);
    record.heading = std::remainder(0.7 * i, 2 * kPi);
    record.wander = 0.4 * std::cos(i);
    const Read found = read(record.bytes(), {.crs = "EPSG:32632"});
    const double on_map =
        record.heading - record.wander - convergence(record.latitude, record.longitude, 32);
    const Rotation expected = navigation_rotation(record.roll, record.pitch, on_map);
    CHECK(greatest_difference(expected, found.poses.at(0).rotation) < 1e-7);
  }
  // East of the central meridian the map's north lies to the east of true north.
  CHECK(convergence(record.latitude, record.longitude, 32) > 0.02);
  record = {.latitude = 0.85, .longitude = 0.19, .heading = kPi / 2};
  const Pose pose = read(record.bytes(), {.crs = "EPSG:32632"}).poses.at(0);
  CHECK(pose.rotation[3] > 0.02);  // so the way to true east climbs on the map
}

TEST_CASE("SBET: the CRS of the environment serves where none is named") {
  const std::string bytes = SbetRecord().bytes();
  check_says(refusal_of_sbet(bytes, {}), "expected the projected coordinate reference system");
  const std::string wkt =
      "PROJCS[\"local\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS "
      "84\",6378137,298.257223563]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],"
      "PROJECTION[\"Transverse_Mercator\"],PARAMETER[\"latitude_of_origin\",0],PARAMETER[\"central_"
      "meridian\",9],PARAMETER[\"scale_factor\",0.9996],PARAMETER[\"false_easting\",500000],"
      "PARAMETER[\"false_northing\",0],UNIT[\"metre\",1]";
  const Read found = read(bytes, {.default_crs = wkt + "]"});
  const Utm expected = utm(0.9, 0.15, 32);
  check_near(found.poses.at(0).translation[0], expected.easting, 1e-5);
  check_near(found.poses.at(0).translation[1], expected.northing, 1e-5);
  check_says(found.find("map-projection")->text, "as the environment");
  const std::string files = wkt + ",EXTENSION[\"PROJ4\",\"+proj=utm +nadgrids=/etc/passwd\"]]";
  check_says(refusal_of_sbet(bytes, {.default_crs = files}), "not opened");
  CHECK(read(bytes, {.default_crs = "+proj=utm +zone=32 +datum=WGS84"}).poses ==
        read(bytes, {.crs = "EPSG:32632"}).poses);
  check_says(refusal_of_sbet(bytes, {.default_crs = "hello"}), "does not know");
  check_says(refusal_of_sbet(bytes, {.default_crs = "GEOGCS[\"a\"]"}), "environment");
}

TEST_CASE("a CRS that cannot be used is refused with what was expected") {
  const std::string bytes = SbetRecord().bytes();
  for (const char* crs : {"EPSG:0", "hello", "EPSG:4326", "EPSG:4979", "EPSG:4978", "+proj=utm"}) {
    INFO(crs);
    CHECK_THROWS_AS(read(bytes, {.crs = crs}), UsageError);
  }
  CHECK_THROWS_AS(read(bytes, {.crs = "EPSG:32632", .datum = "hello"}), UsageError);
  CHECK_THROWS_AS(read(bytes, {.angle_unit = AngleUnit::kDegrees, .crs = "EPSG:32632"}),
                  UsageError);
  CHECK_THROWS_AS(read(bytes, {.crs = "EPSG:32632", .metres_per_unit = 0.001}), UsageError);
  CHECK(read(bytes, {.crs = "+proj=utm +zone=32 +datum=WGS84"}).poses ==
        read(bytes, {.crs = "EPSG:32632"}).poses);
}

TEST_CASE("heights, units and datum of a CRS are said") {
  const SbetRecord california{.latitude = 0.57, .longitude = -2.04, .altitude = 30.48};
  const Read feet = read(california.bytes(), {.crs = "EPSG:2230"});
  CHECK(feet.poses.at(0).translation[2] == Approx(30.48 * 3937 / 1200));
  CHECK(feet.find("map-unit"));
  REQUIRE(feet.find("datum-accuracy"));
  CHECK(feet.find("datum-accuracy")->severity == Message::Severity::kWarning);
  const Read own = read(california.bytes(), {.crs = "EPSG:6425+ellipsoidal", .datum = "EPSG:6319"});
  CHECK(own.find("datum-accuracy") == nullptr);
  CHECK(own.find("ellipsoidal-heights") == nullptr);
  const Read europe = read(SbetRecord().bytes(), {.crs = "EPSG:25832"});
  REQUIRE(europe.find("datum-accuracy"));
  CHECK(europe.find("datum-accuracy")->severity == Message::Severity::kNote);
  const Read mercator = read(SbetRecord().bytes(), {.crs = "EPSG:3857"});
  REQUIRE(mercator.find("map-scale"));
  CHECK(mercator.find("map-scale")->severity == Message::Severity::kWarning);
  // This map nearly keeps lengths along the meridian, but not along the parallel at latitude 0.9.
  const double sine = std::sin(0.9), w2 = 1 - 6.69437999014e-3 * sine * sine;
  const double along = std::sqrt(w2) / std::cos(0.9);
  const double across = std::pow(w2, 1.5) / (1 - 6.69437999014e-3);
  const Read cylinder = read(SbetRecord().bytes(), {.crs = "EPSG:4087"});
  REQUIRE(cylinder.find("map-scale"));
  CHECK(cylinder.find("map-scale")->numbers.at(1).second == Approx(along).epsilon(1e-6));
  CHECK(cylinder.find("map-scale")->numbers.at(2).second ==
        Approx(std::sqrt(along * across)).epsilon(1e-6));
}

TEST_CASE("SBET: degrees, cut files and numbers that are none are refused") {
  const TrajectoryOptions utm32{.crs = "EPSG:32632"};
  SbetRecord record;
  record.latitude = 51.5;
  check_says(refusal_of_sbet(SbetRecord().bytes() + record.bytes(), utm32),
             "byte 136 ... record 1 ... radians, not degrees");
  record = {};
  record.heading = 174.5;
  check_says(refusal_of_sbet(record.bytes(), utm32), "heading ... not degrees");
  record = {};
  record.pitch = std::numeric_limits<double>::quiet_NaN();
  check_says(refusal_of_sbet(record.bytes(), utm32), "pitch nan");
  record = {};
  record.altitude = std::numeric_limits<double>::infinity();
  check_says(refusal_of_sbet(record.bytes(), utm32), "altitude inf");
  record = {};
  record.latitude = record.longitude = 0;
  check_says(refusal_of_sbet(record.bytes(), utm32), "are 0");
  record = {};
  record.time = std::numeric_limits<double>::quiet_NaN();
  check_says(refusal_of_sbet(record.bytes(), utm32), "time");
  const std::string two = SbetRecord().bytes() + SbetRecord().bytes();
  CHECK(read("", utm32).poses.empty());
  for (std::size_t size = 1; size < two.size(); ++size) {
    INFO(size);
    if (size == 136) continue;
    check_says(refusal_of_sbet(two.substr(0, size), utm32), "behind the last whole record of 136");
  }
}

TEST_CASE("SBET is known by its ending, or by .out and its bytes") {
  const std::string bytes = SbetRecord().bytes();
  const TrajectoryOptions utm32{.crs = "EPSG:32632"};
  check_equal(read(bytes, utm32, "path.out").poses.size(), 1);
  check_equal(read(bytes, utm32, "path.SBET").poses.size(), 1);
  check_equal(read("1 0 0 0 0 1 0 0 0 0 1 0\n", {}, "path.out").poses.size(), 1);
  check_says(refusal_of_sbet(bytes, utm32, "path.bin"), "may be an SBET");
  TrajectoryOptions named = utm32;
  named.format = TrajectoryFormat::kSbet;
  check_equal(read(bytes, named, "path.bin").poses.size(), 1);
  const SbetRecord early{.time = 10};
  const SbetRecord late{.time = 20};
  CHECK(read(early.bytes() + late.bytes(), utm32).find("time-order") == nullptr);
  CHECK(read(late.bytes() + early.bytes(), utm32).find("time-order"));
}
