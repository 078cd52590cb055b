// Lengths as people write them.
#include "clearway/error.hpp"
#include "io/files/text_number.hpp"
#include "io/scans/length_unit.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("a length has the double nearest to what is written") {
  check_equal(length_of("0.1")->value, 0.1);
  CHECK_FALSE(length_of("0.1")->has_unit);
  check_equal(length_of("10cm")->value, 0.1);
  check_equal(length_of("-2.5e3 mm")->value, -2.5);
  check_equal(length_of("4 in")->value, 0.1016);
  check_equal(length_of("0.2ft")->in_units_of(kMetresPerFoot), 0.2);
  check_equal(length_of(" 4 in ")->value, 0.1016);
  for (const double foot : {kMetresPerFoot, kMetresPerUsSurveyFoot}) {
    check_equal(length_of("0.33 ft")->in_units_of(foot), 0.33);
  }
  CHECK(length_of("0.33us-ft")->in_units_of(kMetresPerUsSurveyFoot) == Approx(0.33).epsilon(1e-15));
  CHECK(length_of("1e6 ift")->in_units_of(kMetresPerUsSurveyFoot) == Approx(999'998).margin(1e-3));
  check_equal(length_of("1m")->in_units_of(0.5), 2);
  check_equal(length_of("7")->in_units_of(0.5), 7);
}

TEST_CASE("what is no finite length is none") {
  for (const char* text : {"", "far", "m", "1 mile", "1e999", "nan", "1,5", "1m2", "1e5000cm"}) {
    INFO(text);
    CHECK_FALSE(length_of(text));
  }
}

TEST_CASE("units of files are known by their names") {
  check_equal(file_unit_names(), {"mm", "cm", "m", "in", "ft", "ift", "us-ft"});
  CHECK(file_unit_of("in") == FileUnit(0.0254));
  CHECK(file_unit_of("feet") == FileUnit(kMetresPerFoot));
  CHECK(file_unit_of("us survey foot")->metres() == kMetresPerUsSurveyFoot);
  CHECK_FALSE(file_unit_of("km"));
  CHECK_FALSE(file_unit_of(""));
  CHECK_THROWS_AS(FileUnit::named("furlong"), UsageError);
}
