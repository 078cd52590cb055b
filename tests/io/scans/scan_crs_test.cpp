// Units and scales of coordinate reference systems; what is wrong with them is in
// tests/formats/crs.case.
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
    const RowName row(one.name + ": " + one.text);
    const ScanCrs crs = scan_crs_of(one.text);
    check_equal(crs.unread, "");
    const bool degrees = one.unit == "degrees";
    const double metres = degrees ? 0 : std::stod(one.unit);
    CHECK(crs.units.plane == (degrees ? LengthUnit::kDegrees : unit_of_length(metres)));
    const bool is_read = metres == 0 || unit_of_length(metres) != LengthUnit::kUnknown;
    CHECK(crs.units.trouble.empty() == is_read);
    check_near(crs.units.heights, one.heights, 1e-12);
    const auto map = ScanMap::of(one.text);
    CHECK(map.has_value() == (one.farthest != 0));
    if (!map) continue;
    const auto scale = map->at(one.easting, one.northing);
    REQUIRE(scale);
    check_near(scale->error(), std::abs(one.farthest - 1), 2e-8);
    check_near(scale->mean, one.mean, 2e-8);
  }
}

TEST_CASE("heights go with other coordinates in a unit that differs by less than 0.01 %") {
  const double survey = metres_of(LengthUnit::kUsSurveyFoot);
  const std::tuple<double, LengthUnit, const char*> rows[] = {
      {survey, LengthUnit::kMetre,
       "its heights are in us-survey-foot, its other coordinates in metre"},
      {0.9, LengthUnit::kFoot, "its heights are in 0.9 m, its other coordinates in foot"},
      {1.0002, LengthUnit::kMetre, "its heights are in 1.0002 m"},
      {1.00005, LengthUnit::kMetre, ""},
      {survey, LengthUnit::kFoot, ""},
      {0, LengthUnit::kMetre, ""},
      {survey, LengthUnit::kUnknown, ""},
      {survey, LengthUnit::kDegrees, ""}};
  for (const auto& [height_unit, plane, words] : rows) {
    check_says(heights_trouble(height_unit, plane), words);
  }
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
