#include "io/scans/las/geotiff_keys.hpp"

#include <array>
#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include "io/scans/map_scale.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A key with a short, or with a number or a text in a record of its own.
struct Key {
  std::uint16_t key;
  std::variant<int, double, std::string> value;
};

GeotiffKeys keys_of(const std::vector<Key>& keys) {
  std::vector<std::uint16_t> words{1, 1, 0, static_cast<std::uint16_t>(keys.size())};
  std::vector<double> numbers;
  std::string texts;
  const auto add = [&](std::uint16_t key, int record, std::size_t count, std::size_t at) {
    words.insert(words.end(), {key, static_cast<std::uint16_t>(record),
                               static_cast<std::uint16_t>(count), static_cast<std::uint16_t>(at)});
  };
  for (const Key& key : keys) {
    if (const auto* const code = std::get_if<int>(&key.value)) {
      add(key.key, 0, 1, static_cast<std::size_t>(*code));
    } else if (const auto* const number = std::get_if<double>(&key.value)) {
      add(key.key, 34736, 1, numbers.size());
      numbers.push_back(*number);
    } else {
      const std::string text = std::get<std::string>(key.value) + "|";
      add(key.key, 34737, text.size(), texts.size());
      texts += text;
    }
  }
  GeotiffKeys out;
  out.take(34737, std::as_bytes(std::span(texts)));
  out.take(34736, std::as_bytes(std::span(numbers)));
  out.take(34735, std::as_bytes(std::span(words)));
  return out;
}

constexpr double kFoot = 0.3048, kSurveyFoot = 1200.0 / 3937;

/// What keys mean. place, scale: of the map, as crs_cases.tsv has them for the same map by code; a
/// scale of 0 where the keys name no map.
struct Case {
  std::string name;
  std::vector<Key> keys;
  LengthUnit plane = LengthUnit::kUnknown;
  double heights = 0;
  std::array<double, 2> place{};
  double scale = 0;
};

const std::array<double, 2> kUtm32{649187.875, 5318235.614};
const std::array<double, 2> kOregon{655282.752, 848375.476};
constexpr auto kMetre = LengthUnit::kMetre;

const std::string kPeString =
    R"(ESRI PE String = PROJCS["NAD_1983_StatePlane_California_III_FIPS_0403_Feet",)"
    R"(GEOGCS["GCS_North_American_1983",DATUM["D_North_American_1983",)"
    R"(SPHEROID["GRS_1980",6378137.0,298.257222101]],PRIMEM["Greenwich",0.0],)"
    R"(UNIT["Degree",0.0174532925199433]],PROJECTION["Lambert_Conformal_Conic"],)"
    R"(PARAMETER["False_Easting",6561666.666666666],PARAMETER["False_Northing",1640416.666666667],)"
    R"(PARAMETER["Central_Meridian",-120.5],PARAMETER["Standard_Parallel_1",37.06666666666667],)"
    R"(PARAMETER["Standard_Parallel_2",38.43333333333333],)"
    R"(PARAMETER["Latitude_Of_Origin",36.5],UNIT["Foot_US",0.3048006096012192]])";
const std::array<double, 2> kCalifornia{6126548.244, 2008012.813};

const std::vector<Case> kCases{
    {"nothing", {}},
    {"a code", {{1024, 1}, {3072, 25832}}, kMetre, 0, kUtm32, 0.9998734899},
    {"a code and a unit",
     {{1024, 1}, {3072, 25832}, {3076, 9001}},
     kMetre,
     0,
     kUtm32,
     0.9998734899},
    {"a code in US survey feet",
     {{1024, 1}, {3072, 2227}},
     LengthUnit::kUsSurveyFoot,
     0,
     {6126548.244, 2008012.813},
     0.9999387279},
    {"a code with a system of heights in feet",
     {{1024, 1}, {3072, 26917}, {3076, 9001}, {4096, 6360}},
     kMetre,
     kSurveyFoot,
     {588977.324, 4095339.691},
     0.9996975207},
    {"a code and a unit of heights",
     {{1024, 1}, {3072, 25832}, {4099, 9002}},
     kMetre,
     kFoot,
     kUtm32,
     0.9998734899},
    {"a compound code",
     {{1024, 1}, {3072, 25832}, {4096, 5783}, {4099, 9001}},
     kMetre,
     1,
     kUtm32,
     0.9998734899},
    {"a unit alone", {{1024, 1}, {3076, 9002}}, LengthUnit::kFoot},
    {"the length of a unit",
     {{1024, 1}, {3072, 32767}, {3076, 32767}, {3077, kSurveyFoot}},
     LengthUnit::kUsSurveyFoot},
    {"the length of a unit alone", {{3077, kFoot}}, LengthUnit::kFoot},
    {"heights alone", {{4099, 9003}}, LengthUnit::kUnknown, kSurveyFoot},
    {"geographic", {{1024, 2}, {2048, 4326}}, LengthUnit::kDegrees},
    {"geographic without a type", {{2048, 4326}}, LengthUnit::kDegrees},
    {"geographic with heights", {{1024, 2}, {2048, 4979}}, LengthUnit::kDegrees, 1},
    {"geocentric", {{1024, 3}, {2048, 4978}, {2052, 9001}}, kMetre, 1},
    {"its own transverse Mercator",
     {{1024, 1},
      {2048, 4258},
      {3072, 32767},
      {3075, 1},
      {3076, 9001},
      {3080, 9.0},
      {3081, 0.0},
      {3082, 500000.0},
      {3083, 0.0},
      {3092, 0.9996}},
     kMetre,
     0,
     kUtm32,
     0.9998734899},
    {"its own transverse Mercator in grads",
     {{1024, 1},
      {2048, 4258},
      {2054, 9105},
      {3072, 32767},
      {3075, 1},
      {3076, 9001},
      {3080, 10.0},
      {3082, 500000.0},
      {3092, 0.9996}},
     kMetre,
     0,
     kUtm32,
     0.9998734899},
    {"its own Lambert map in feet",
     {{1024, 1},
      {2048, 32767},
      {2056, 7019},
      {3072, 32767},
      {3075, 8},
      {3076, 9002},
      {3078, 43.0},
      {3079, 45.5},
      {3084, -120.5},
      {3085, 41.75},
      {3086, 1312335.958005249},
      {3087, 0.0}},
     LengthUnit::kFoot,
     0,
     kOregon,
     0.9997691734},
    {"its own ellipsoid",
     {{1024, 1},
      {2048, 32767},
      {2057, 6378137.0},
      {2059, 298.257222101},
      {3072, 32767},
      {3075, 1},
      {3076, 9001},
      {3080, 9.0},
      {3082, 500000.0},
      {3092, 0.9996}},
     kMetre,
     0,
     kUtm32,
     0.9998734899},
    {"a projection by code",
     {{1024, 1}, {2048, 4258}, {3072, 32767}, {3074, 16032}, {3076, 9001}},
     kMetre,
     0,
     kUtm32,
     0.9998734899},
    {"a citation with well-known text alone",
     {{1024, 32767}, {3072, 32767}, {3073, kPeString}},
     LengthUnit::kUsSurveyFoot,
     0,
     kCalifornia,
     0.9999387279},
    {"a citation with a name alone",
     {{1024, 1}, {3072, 32767}, {3073, "PCS Name = NAD83 / California zone 3 (ftUS)"}},
     LengthUnit::kUsSurveyFoot,
     0,
     kCalifornia,
     0.9999387279},
    {"a citation of all with a name",
     {{1024, 1}, {1026, "NAD83 / California zone 3 (ftUS)|x"}},
     LengthUnit::kUsSurveyFoot,
     0,
     kCalifornia,
     0.9999387279},
    {"a citation that names a unit",
     {{1024, 1}, {3072, 32767}, {3073, "PCS Name = Site_7|LUnits = US survey foot"}},
     LengthUnit::kUsSurveyFoot},
    {"a citation of a site in metres", {{1024, 1}, {1026, "Site 7, meters"}}, kMetre},
    {"a citation of what says nothing of a unit", {{1024, 1}, {1026, "Site 7, zone M"}}},
    {"a citation of the geographic system below", {{1024, 1}, {1026, "WGS 84"}}},
    {"a code and citations that say otherwise",
     {{1024, 1}, {1026, "feet"}, {3072, 25832}, {3073, "(ftUS)"}},
     kMetre,
     0,
     kUtm32,
     0.9998734899},
    {"a citation of heights",
     {{1024, 1}, {3072, 25832}, {4096, 32767}, {4097, "NAVD88 height (ftUS)"}},
     kMetre,
     kSurveyFoot,
     kUtm32,
     0.9998734899},
    {"a citation of both",
     {{1024, 1}, {1026, "NAD83 / California zone 3 (ftUS) + Datum 7 (Feet)"}},
     LengthUnit::kUsSurveyFoot,
     kFoot,
     kCalifornia,
     0.9999387279},
    {"a citation of a site in metres with heights in feet",
     {{1024, 1}, {1026, "Site 7 (metres) + NAVD88 height (ftUS)"}},
     kMetre,
     kSurveyFoot},
    {"a citation of heights in feet",
     {{1024, 1}, {3072, 25832}, {4097, "Datum 7, Feet"}},
     kMetre,
     kFoot,
     kUtm32,
     0.9998734899},
    {"a system in the key of units, and a geodetic unit",
     {{1024, 1}, {2052, 9001}, {3076, 32632}},
     kMetre}};

}  // namespace

TEST_CASE("GeoTIFF keys name units and maps") {
  for (const Case& one : kCases) {
    INFO(one.name);
    const GeotiffCrs crs = keys_of(one.keys).crs();
    CHECK(crs.units.plane == one.plane);
    check_near(crs.units.heights, one.heights, 1e-12);
    check_equal(crs.units.trouble + crs.units.doubt, "");
    const auto map = ScanMap::of(crs.crs);
    REQUIRE(map.has_value() == (one.scale > 0));
    if (!map) continue;
    const auto scale = map->at(one.place[0], one.place[1]);
    REQUIRE(scale);
    check_near(scale->error(), std::abs(one.scale - 1), 2e-8);
  }
}

TEST_CASE("GeoTIFF keys that are not understood are named") {
  const auto unread = [](const std::vector<Key>& keys) {
    const GeotiffCrs crs = keys_of(keys).crs();
    return crs.unread + crs.unread_heights;
  };
  check_says(unread({{1024, 1}, {3076, 32632}}), "key 3076 is 32632");
  check_says(unread({{1024, 1}, {3076, 32767}}), "key 3076 is 32767 (user-defined)");
  check_says(unread({{1024, 1}, {3076, 32767}, {3077, -1.0}}), "key 3076");
  check_says(unread({{1024, 1}, {3072, 1}}), "key 3072 is 1,");
  check_says(unread({{1024, 1}, {3072, 4326}}), "key 3072 is 4326");
  check_says(unread({{1024, 7}}), "key 1024 is 7");
  check_says(unread({{1024, 32767}, {3072, 32767}}), "projection of their own");
  check_says(unread({{1024, 1}, {3072, 32767}, {2052, 9001}, {3073, "Site 7 Feet"}}),
             "citation \"Site 7 Feet\" is in feet and does not say which");
  check_says(unread({{1024, 1}, {3072, 25832}, {4096, 5030}}), "key 4096 is 5030");
  check_says(unread({{1024, 1}, {3072, 25832}, {4096, 32767}}), "key 4096 is 32767");
  check_says(unread({{1024, 1}, {3072, 25832}, {4099, 9102}}), "key 4099 is 9102");
  check_says(unread({{1024, 1}, {3072, 32767}, {3075, 27}, {3076, 9001}}),
             "projection of their own");
  CHECK(unread({{1024, 1}, {3072, 25832}, {4096, 5030}, {4099, 9001}}).empty());
}

TEST_CASE("GeoTIFF keys that contradict each other or cannot be used as they are") {
  const auto units = [](const std::vector<Key>& keys) { return keys_of(keys).crs().units; };
  check_equal(units({{1024, 1}, {3076, 9036}}).trouble, "its unit is 1000 m");
  check_equal(units({{1024, 1}, {3072, 25832}, {4096, 5715}}).trouble,
              "its heights count downwards");
  check_says(units({{1024, 1}, {3072, 2230}, {3076, 9001}}).doubt,
             "they name the unit metre ... EPSG:2230");
  check_says(units({{1024, 1}, {3072, 26917}, {4096, 6360}, {4099, 9001}}).doubt,
             "they name metre for heights");
}
