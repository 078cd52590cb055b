// The lines that messages name for points, in every text format.
#include <algorithm>
#include <catch2/catch.hpp>

#include "support/bytes/pcd_bytes.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("the lines of points in a text are told") {
  ReaderScratch scratch;
  const auto lines = [&](const char* name, const std::string& text,
                         std::vector<std::uint64_t> points) {
    return open_point_file(scratch.write(name, text))->lines_of(points);
  };
  using Lines = std::vector<std::uint64_t>;
  CHECK(lines("a.pts", "2\n1 2 3\n\n4 5 6\n1\n7 8 9\n", {0, 1, 2}) == Lines{2, 4, 6});
  const std::string axes = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  CHECK(lines("a.ptx", "1\n2\n" + axes + "1 2 3\n0 0 0\n1\n1\n" + axes + "7 8 9\n", {0, 2}) ==
        Lines{11, 23});
  CHECK(lines("a.3d", "3 points\n1 2 3\n4 5 6\n# any\n7 8 9\n", {1, 2}) == Lines{3, 5});
  PcdHeaderText pcd;
  CHECK(lines("a.pcd", pcd.build("ascii") + "1 2 3\n\n4 5 6\n", {1}) ==
        Lines{static_cast<std::uint64_t>(std::ranges::count(pcd.build("ascii"), '\n')) + 3});
  const auto reader =
      open_point_file(scratch.write("a.csv", "# any\nx,y,z\n1,2,3\n\n4,5,6\n# any\n7,8,9\n"));
  CHECK(reader->lines_of(std::vector<std::uint64_t>{0, 2}) == std::vector<std::uint64_t>{3, 7});
  CHECK(reader->lines_of(std::vector<std::uint64_t>{1}) == std::vector<std::uint64_t>{5});
}
