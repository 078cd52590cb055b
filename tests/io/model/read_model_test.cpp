#include <catch2/catch.hpp>

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
