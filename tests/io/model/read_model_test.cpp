#include <catch2/catch.hpp>

#include "clearway/error.hpp"
#include "clearway/model.hpp"
#include "support/bytes/las_bytes.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Matchers::Contains;

namespace {

std::string refusal_of_model(const std::filesystem::path& path) {
  try {
    read_model(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("a model of integers is placed by scale and offset") {
  ReaderScratch scratch;
  const auto points = read_model(scratch.write("a.las", LasBytes().build()));
  REQUIRE(points.size() == 3);
  CHECK(points[0] == Vec3{1 * 0.001 + 100, 2 * 0.01 - 200, 3 * 0.1});
  CHECK(read_model(scratch.write("a.xyz", "1 2 3\n")) == std::vector<Vec3>{{1, 2, 3}});
}

TEST_CASE("a model without points or with a point that is not finite is refused") {
  ReaderScratch scratch;
  CHECK_THAT(refusal_of_model(scratch.write("a.xyz", "# none\n")), Contains("no points"));
  CHECK_THAT(refusal_of_model(scratch.write("a.xyz", "1 2 3\n1 nan 3\n")),
             Contains("model point 1") && Contains("finite"));
}

TEST_CASE("a unit that the file or the caller names is converted into the environment's") {
  ReaderScratch scratch;
  LasBytes las;
  las.vlrs = {{"LASF_Projection", 2112, "LOCAL_CS[\"feet\",UNIT[\"foot\",0.3048]]"}};
  const auto feet = scratch.write("a.las", las.build());
  const double x = 1 * 0.001 + 100;
  std::vector<Message> messages;
  CHECK(read_model(feet, &messages)[0].x == x * 0.3048);
  REQUIRE(messages.size() == 1);
  CHECK(messages[0].severity == Message::Severity::kNote);
  CHECK_THAT(messages[0].text, Contains("its unit is 0.3048 m"));
  CHECK(read_model(feet, {.environment_unit = 0.3048})[0].x == x);
  CHECK(read_model(feet, {.unit = 1})[0].x == x);

  const auto unknown = scratch.write("a.xyz", "914.4 2 3\n");
  CHECK(read_model(unknown, {.environment_unit = 0.3048})[0].x == 914.4);
  CHECK(read_model(unknown, {.unit = 0.001})[0].x == 0.9144);
  CHECK(read_model(unknown, {.unit = 0.001, .environment_unit = 0.3048})[0].x == Approx(3));
  CHECK_THROWS_AS(read_model(unknown, {.unit = -1}), UsageError);
  CHECK_THROWS_AS(read_model(unknown, {.environment_unit = 0}), UsageError);
}
