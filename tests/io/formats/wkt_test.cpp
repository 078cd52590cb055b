#include "io/formats/wkt.hpp"

#include <catch2/catch.hpp>
#include <string>

using namespace clearway;

TEST_CASE("the unit of a projected system is its own, not that of its parts") {
  const std::string geographic = R"(GEOGCS["g",DATUM["d",SPHEROID["s",6378137,298.3]],)"
                                 R"(UNIT["degree",0.0174532925199433]])";
  const auto projected = [&](const std::string& unit) {
    return "PROJCS[\"p\"," + geographic + ",PARAMETER[\"k\",1]," + unit + ",AXIS[\"X\",EAST]]";
  };
  const std::string metre = R"(UNIT["metre",1,AUTHORITY["EPSG","9001"]])";
  const std::string survey_foot = R"(UNIT["US survey foot",0.3048006096012192])";
  const std::string foot = R"(UNIT["foot",0.3048])";
  CHECK(horizontal_unit(projected(metre)) == LengthUnit::kMetre);
  CHECK(horizontal_unit(projected(foot)) == LengthUnit::kFoot);
  CHECK(horizontal_unit(projected(survey_foot)) == LengthUnit::kUsSurveyFoot);
  CHECK(horizontal_unit(projected(R"(UNIT["km",1000])")) == LengthUnit::kUnknown);
  CHECK(horizontal_unit(geographic) == LengthUnit::kDegree);

  const std::string vertical = "VERT_CS[\"v\",VERT_DATUM[\"d\",2005]," + foot + "]";
  CHECK(horizontal_unit("COMPD_CS[\"c\"," + projected(survey_foot) + "," + vertical + "]") ==
        LengthUnit::kUsSurveyFoot);
  CHECK(horizontal_unit("COMPD_CS[\"c\"," + vertical + "," + projected(metre) + "]") ==
        LengthUnit::kMetre);
  CHECK(horizontal_unit("COMPD_CS[\"c\"," + geographic + "," + vertical + "]") ==
        LengthUnit::kDegree);
}

TEST_CASE("well-known text 2 is understood") {
  const std::string base =
      R"(BASEGEOGCRS["b",DATUM["d",ELLIPSOID["e",1,2,LENGTHUNIT["metre",1]]]])";
  const std::string conversion =
      R"(CONVERSION["c",PARAMETER["e",500000,LENGTHUNIT["metre",1]]],CS[Cartesian,2])";
  const std::string axis_unit = R"(AXIS["E",east,ORDER[1],LENGTHUNIT["foot",0.3048]])";
  CHECK(horizontal_unit("PROJCRS[\"p\"," + base + "," + conversion +
                        R"(,AXIS["E",east],LENGTHUNIT["US survey foot",0.304800609601219]])") ==
        LengthUnit::kUsSurveyFoot);
  CHECK(horizontal_unit("PROJCRS[\"p\"," + base + ",\n  " + conversion + ",\n  " + axis_unit +
                        "]") == LengthUnit::kFoot);
  CHECK(horizontal_unit(R"(GEOGCRS["g",CS[ellipsoidal,2],ANGLEUNIT["degree",0.0174532925]])") ==
        LengthUnit::kDegree);
  CHECK(horizontal_unit(R"(GEODCRS["g",CS[Cartesian,3],LENGTHUNIT["metre",1]])") ==
        LengthUnit::kMetre);
  CHECK(horizontal_unit(R"(GEODCRS["g",CS[ellipsoidal,3]])") == LengthUnit::kDegree);
}

TEST_CASE("text that is no well-known text tells no unit and does no harm") {
  for (const std::string text : {"", "]", "PROJCS", "PROJCS[", "PROJCS[\"", "UNIT[\"metre\",1]",
                                 "]]PROJCS[UNIT[1]]", "[[[["}) {
    CHECK(horizontal_unit(text) == LengthUnit::kUnknown);
  }
  std::string deep;
  for (int i = 0; i < 20'000; ++i) deep += "A[";
  CHECK(horizontal_unit(deep) == LengthUnit::kUnknown);
}
