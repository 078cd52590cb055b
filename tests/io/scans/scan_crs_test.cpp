#include "io/scans/scan_crs.hpp"

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "io/scans/map_scale.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A system and what PROJ says of it; see crs_cases.py.
struct Case {
  std::string name, unit, text;
  double heights = 0, easting = 0, northing = 0, farthest = 0, mean = 0;
};

std::vector<Case> all_cases() {
  std::ifstream file(CLEARWAY_CRS_CASES);
  REQUIRE(file);
  std::vector<Case> cases;
  for (Case one; std::getline(file, one.name, '\t');) {
    std::string numbers;
    std::getline(file, one.unit, '\t');
    file >> one.heights >> one.easting >> one.northing >> one.farthest >> one.mean;
    file.ignore();
    std::getline(file, one.text);
    cases.push_back(one);
  }
  return cases;
}

/// How the units of a system differ from what is expected; empty where they do not.
std::string wrong_units(const Case& expected, const CrsUnits& found) {
  if (expected.unit == "degrees") {
    if (found.plane != LengthUnit::kDegrees) return "is not in degrees";
  } else {
    const double metres = std::stod(expected.unit);
    const bool is_read = unit_of_length(metres) != LengthUnit::kUnknown || metres == 0;
    if (found.plane != (is_read ? unit_of_length(metres) : LengthUnit::kUnknown)) {
      return "is in " + to_string(found.plane);
    }
    if (is_read != found.trouble.empty()) return "has the trouble: " + found.trouble;
  }
  if (std::abs(found.heights - expected.heights) > 1e-12) {
    return "has heights in " + std::to_string(found.heights);
  }
  return {};
}

/// How the scale of a map differs from what is expected; empty where it does not.
std::string wrong_scale(const Case& expected) {
  constexpr double kSame = 2e-8;
  const auto map = ScanMap::of(expected.text);
  if (!map) return expected.farthest == 0 ? "" : "is no map";
  if (expected.farthest == 0) return "is a map";
  const auto scale = map->at(expected.easting, expected.northing);
  if (!scale) return "has no scale";
  const bool is_right = std::abs(scale->error() - std::abs(expected.farthest - 1)) < kSame &&
                        std::abs(scale->mean - expected.mean) < kSame;
  return is_right ? ""
                  : "has the scale " + std::to_string(scale->farthest) + ", by area " +
                        std::to_string(scale->mean);
}

const std::string kPlane =
    R"(PROJCS["p",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],)"
    R"(PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],)"
    R"(PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],)"
    R"(PARAMETER["central_meridian",9],PARAMETER["scale_factor",0.9996],)"
    R"(PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1])";

std::string with_unit(const std::string& unit) {
  std::string text = kPlane;
  return text.replace(text.rfind("UNIT"), std::string::npos, unit + "]");
}

std::string heights(const std::string& unit, const std::string& axis = "UP") {
  return "VERT_CS[\"v\",VERT_DATUM[\"d\",2005]," + unit + ",AXIS[\"h\"," + axis + "]]";
}

std::string text_of(std::u16string_view text, bool big) {
  std::string bytes;
  for (const char16_t c : text) {
    const char low = static_cast<char>(c & 0xFF), high = static_cast<char>(c >> 8);
    bytes += big ? std::string{high, low} : std::string{low, high};
  }
  return bytes;
}

std::string decoded(const std::string& bytes) {
  return crs_text_of(std::as_bytes(std::span(bytes)));
}

}  // namespace

TEST_CASE("units and scales of coordinate reference systems of every kind are those of PROJ") {
  const std::vector<Case> cases = all_cases();
  REQUIRE(cases.size() > 60);
  for (const Case& one : cases) {
    INFO(one.name << ": " << one.text);
    const ScanCrs crs = scan_crs_of(one.text);
    CHECK(crs.unread.empty());
    CHECK(wrong_units(one, crs.units).empty());
    CHECK(wrong_scale(one).empty());
  }
}

TEST_CASE("what PROJ does not read of a system is known, and does no harm") {
  const std::string plane = kPlane + "]";
  std::string deep = "PROJCS[\"a\"", json = R"({"type":"ProjectedCRS")";
  for (int i = 0; i < 20'000; ++i) {
    deep += ",A[";
    json += R"(,"base_crs":{"a":1)";
  }
  for (const std::string& text :
       std::vector<std::string>{"]",
                                "PROJCS",
                                "PROJCS[",
                                "PROJCS[\"",
                                "UNIT[\"metre\",1]",
                                "]]PROJCS[UNIT[1]]",
                                "[[[[",
                                "hall",
                                "Unknown",
                                "UTM32",
                                "+units=m",
                                "{}",
                                "26910",
                                "EPSG:99999",
                                kPlane,
                                plane + ",foo",
                                plane + "," + heights("UNIT"),
                                plane + "," + with_unit("UNIT[\"m\",1]"),
                                "COMPD_CS[\"c\"," + heights("UNIT[\"m\",1]") + "," + plane + "]",
                                deep,
                                std::string(32'000, 'A') + std::string(33'000, '['),
                                json}) {
    INFO(text.substr(0, 300));
    CHECK_FALSE(scan_crs_of(text).unread.empty());
  }
  for (const std::string& text :
       std::vector<std::string>{"", plane + " \n", plane + "]]", plane + "," + plane,
                                "  " + plane + ",", "COMPD_CS[\"c\"," + plane + "]"}) {
    INFO(text);
    CHECK(scan_crs_of(text).unread.empty());
  }
}

TEST_CASE("no text makes PROJ open a file") {
  const std::string extension = kPlane + ",EXTENSION[\"PROJ4\",\"+proj=utm +zone=32 ";
  for (const std::string& text : std::vector<std::string>{
           extension + "+nadgrids=/etc/passwd\"]]", extension + "+ nadgrids = /etc/passwd\"]]",
           extension + "+init=epsg:4326\"]]",
           "+proj=pipeline +step +proj=tinshift +file=/etc/passwd",
           "+proj=defmodel +model=/etc/passwd +type=crs", "+init=/etc/passwd:a +type=crs",
           "+proj=longlat +geoidgrids=/etc/passwd +type=crs"}) {
    INFO(text);
    CHECK(names_files(text));
    CHECK_FALSE(scan_crs_of(text).unread.empty());
  }
  CHECK(names_files(R"(PARAMETERFILE["Geoid (height correction) model file","a.tif"])"));
  CHECK(names_files(R"({"name":"Vertical offset file","value":"/etc/passwd"})"));
  CHECK(names_files(R"({"name":"Vertical offset fil\u0065","value":"/etc/passwd"})"));
  CHECK_FALSE(names_files(extension + "+nadgrids=@null +wktext\"]]"));
}

TEST_CASE("units that cannot be taken as they are make trouble") {
  const auto trouble = [](const std::string& text) { return scan_crs_of(text).units.trouble; };
  CHECK(trouble(with_unit(R"(UNIT["metre",1])")).empty());
  CHECK(trouble(with_unit(R"(UNIT["US survey foot",0.304801])")).empty());
  check_equal(trouble(with_unit(R"(UNIT["kilometre",1000])")), "its unit is 1000 m");
  check_equal(trouble(with_unit(R"(UNIT["yard",0.9144])")), "its unit is 0.9144 m");
  check_equal(trouble(with_unit(R"(UNIT["foot",1])")), "its unit is named \"foot\" and has 1 m");
  CHECK(trouble(kPlane + "]," + heights(R"(UNIT["metre",1])", "DOWN")) ==
        "its heights count downwards");
  const std::string both = "COMPD_CS[\"c\"," + kPlane + "]," + heights(R"(UNIT["metre",1])") + "],";
  CHECK(trouble(both + heights(R"(UNIT["foot",0.3048])")) ==
        "it names two systems of heights, in metre and in foot");
  CHECK(trouble(both + heights(R"(UNIT["metre",1])")).empty());
}

TEST_CASE("heights go with other coordinates in a unit that differs by less than 0.01 %") {
  const double survey = metres_of(LengthUnit::kUsSurveyFoot);
  CHECK(heights_trouble(survey, LengthUnit::kMetre) ==
        "its heights are in us-survey-foot, its other coordinates in metre");
  CHECK(heights_trouble(0.9, LengthUnit::kFoot) ==
        "its heights are in 0.9 m, its other coordinates in foot");
  CHECK(heights_trouble(1.0002, LengthUnit::kMetre).starts_with("its heights are in 1.0002 m"));
  CHECK(heights_trouble(1.00005, LengthUnit::kMetre).empty());
  CHECK(heights_trouble(survey, LengthUnit::kFoot).empty());
  CHECK(heights_trouble(0, LengthUnit::kMetre).empty());
  CHECK(heights_trouble(survey, LengthUnit::kUnknown).empty());
  CHECK(heights_trouble(survey, LengthUnit::kDegrees).empty());
}

TEST_CASE("the text of a record ends at its first zero, and may be UTF-16") {
  const std::string text = "LOCAL_CS[\"\xC3\xA4 \xF0\x9F\x9A\x9A\"]";
  const std::u16string wide = u"LOCAL_CS[\"\u00E4 \U0001F69A\"]";
  using namespace std::string_literals;
  CHECK(decoded(text) == text);
  CHECK(decoded(" " + text + "\n\0 more"s) == text);
  CHECK(decoded("\xEF\xBB\xBF" + text) == text);
  for (const bool big : {false, true}) {
    const std::string bytes = text_of(wide, big);
    CHECK(decoded(bytes) == text);
    CHECK(decoded(text_of(u"\uFEFF", big) + bytes) == text);
    CHECK(decoded(bytes + "\0\0a\0"s) == text);
    CHECK(decoded(bytes + "\0"s) == text);
  }
  for (const std::string& bytes : {""s, "\0"s, "\0\0\0\0\0"s, "\xFF\xFE"s, "\xFF"s}) {
    CHECK(decoded(bytes).size() <= 1);
  }
}
