#include <catch2/catch.hpp>
#include <string>

#include "io/scans/scan_crs.hpp"

using namespace clearway;

namespace {

LengthUnit unit_of(const std::string& wkt) { return units_of_wkt(wkt).horizontal; }

std::string projected(const std::string& unit) {
  return "PROJCS[\"p\"," + unit + ",AXIS[\"X\",EAST]]";
}

}  // namespace

TEST_CASE("the unit of a projected system is its own, not that of its parts") {
  const std::string geographic = R"(GEOGCS["g",DATUM["d",SPHEROID["s",6378137,298.3]],)"
                                 R"(UNIT["degree",0.0174532925199433]])";
  const auto projected = [&](const std::string& unit) {
    return "PROJCS[\"p\"," + geographic + ",PARAMETER[\"k\",1]," + unit + ",AXIS[\"X\",EAST]]";
  };
  const std::string metre = R"(UNIT["metre",1,AUTHORITY["EPSG","9001"]])";
  const std::string survey_foot = R"(UNIT["US survey foot",0.3048006096012192])";
  const std::string foot = R"(UNIT["foot",0.3048])";
  CHECK(unit_of(projected(metre)) == LengthUnit::kMetre);
  CHECK(unit_of(projected(foot)) == LengthUnit::kFoot);
  CHECK(unit_of(projected(survey_foot)) == LengthUnit::kUsSurveyFoot);
  CHECK(unit_of(projected(R"(UNIT["km",1000])")) == LengthUnit::kUnknown);
  CHECK(unit_of(geographic) == LengthUnit::kDegrees);

  const std::string vertical = "VERT_CS[\"v\",VERT_DATUM[\"d\",2005]," + foot + "]";
  CHECK(unit_of("COMPD_CS[\"c\"," + projected(survey_foot) + "," + vertical + "]") ==
        LengthUnit::kUsSurveyFoot);
  CHECK(unit_of("COMPD_CS[\"c\"," + vertical + "," + projected(metre) + "]") == LengthUnit::kMetre);
  CHECK(unit_of("COMPD_CS[\"c\"," + geographic + "," + vertical + "]") == LengthUnit::kDegrees);
}

TEST_CASE("well-known text 2 is understood") {
  const std::string base =
      R"(BASEGEOGCRS["b",DATUM["d",ELLIPSOID["e",1,2,LENGTHUNIT["metre",1]]]])";
  const std::string conversion =
      R"(CONVERSION["c",PARAMETER["e",500000,LENGTHUNIT["metre",1]]],CS[Cartesian,2])";
  const std::string axis_unit = R"(AXIS["E",east,ORDER[1],LENGTHUNIT["foot",0.3048]])";
  CHECK(unit_of("PROJCRS[\"p\"," + base + "," + conversion +
                R"(,AXIS["E",east],LENGTHUNIT["US survey foot",0.304800609601219]])") ==
        LengthUnit::kUsSurveyFoot);
  CHECK(unit_of("PROJCRS[\"p\"," + base + ",\n  " + conversion + ",\n  " + axis_unit + "]") ==
        LengthUnit::kFoot);
  CHECK(unit_of(R"(GEOGCRS["g",CS[ellipsoidal,2],ANGLEUNIT["degree",0.0174532925]])") ==
        LengthUnit::kDegrees);
  CHECK(unit_of(R"(GEODCRS["g",CS[Cartesian,3],LENGTHUNIT["metre",1]])") == LengthUnit::kMetre);
  CHECK(unit_of(R"(GEODCRS["g",CS[ellipsoidal,3]])") == LengthUnit::kDegrees);
}

TEST_CASE("text that is no well-known text tells no unit and does no harm") {
  for (const std::string text : {"", "]", "PROJCS", "PROJCS[", "PROJCS[\"", "UNIT[\"metre\",1]",
                                 "]]PROJCS[UNIT[1]]", "[[[["}) {
    CHECK(unit_of(text) == LengthUnit::kUnknown);
  }
  std::string deep;
  for (int i = 0; i < 20'000; ++i) deep += "A[";
  CHECK(unit_of(deep) == LengthUnit::kUnknown);
}

TEST_CASE("units with few digits are the nearest of ours") {
  CHECK(unit_of(projected(R"(UNIT["US survey foot",0.3048006])")) == LengthUnit::kUsSurveyFoot);
  CHECK(unit_of(projected(R"(UNIT["US survey foot",0.304801])")) == LengthUnit::kUsSurveyFoot);
  CHECK(unit_of(projected(R"(UNIT["foot",0.30480])")) == LengthUnit::kFoot);
  CHECK(unit_of(projected(R"(UNIT["metre",1.0])")) == LengthUnit::kMetre);
}

TEST_CASE("units that cannot be taken as they are make trouble") {
  const auto trouble = [](const std::string& wkt) { return units_of_wkt(wkt).trouble; };
  CHECK(trouble(projected(R"(UNIT["metre",1])")).empty());
  CHECK(trouble(projected(R"(UNIT["kilometre",1000])")) == "its unit is 1000 m");
  CHECK(trouble(projected(R"(UNIT["yard",0.9144])")) == "its unit is 0.9144 m");
  CHECK(trouble(projected(R"(UNIT["Clarke's foot",0.3047972654])")) ==
        "its unit is 0.3047972654 m");
  const auto with_heights = [](const std::string& plane, const std::string& heights) {
    return "COMPD_CS[\"c\"," + projected(plane) + ",VERT_CS[\"v\",VERT_DATUM[\"d\",2005]," +
           heights + ",AXIS[\"up\",UP]]]";
  };
  const std::string metre = R"(UNIT["metre",1])", foot = R"(UNIT["foot",0.3048])";
  const std::string survey_foot = R"(UNIT["US survey foot",0.304800609601219])";
  CHECK(trouble(with_heights(metre, metre)).empty());
  CHECK(trouble(with_heights(survey_foot, survey_foot)).empty());
  CHECK(trouble(with_heights(metre, survey_foot)) ==
        "its heights are in us-survey-foot, its other coordinates in metre");
  CHECK(trouble(with_heights(foot, survey_foot)) ==
        "its heights are in us-survey-foot, its other coordinates in foot");
}
