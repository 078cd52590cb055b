#include <catch2/catch.hpp>

#include "io/scans/ptx/ptx_reader.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Matchers::Contains;

namespace {

ReadCloud read_pts_text(const std::string& text) {
  ReaderScratch scratch;
  const auto reader = open_point_file(scratch.write("a.pts", text));
  const ReadCloud first = read_all(*reader);
  reader->rewind();
  const ReadCloud second = read_all(*reader);
  CHECK(first.positions == second.positions);
  CHECK(first.info.remarks.size() == second.info.remarks.size());
  return first;
}

std::string refusal_of_pts(const std::string& text) {
  ReaderScratch scratch;
  const auto path = scratch.write("a.pts", text);
  const std::string refusal = refusal_of(path);
  CHECK_THAT(refusal, Contains(path.string()));
  return refusal;
}

const std::vector<Vec3> kTwoOfPts{{1, -2.5, 3e2}, {4, 5, 6}};

}  // namespace

TEST_CASE("a PTS file: its number of points, then lines with anything behind x y z") {
  const auto cloud = read_pts_text("2\n1 -2.5 3e2 -1613 52 70 64\n4 5 6 7 8 9 10\n");
  CHECK(cloud.positions == kTwoOfPts);
  CHECK(cloud.info.declared_points == 2u);
  CHECK(cloud.info.remarks.empty());
  CHECK(read_pts_text("\xEF\xBB\xBF"
                      "2 \r\n1 -2.5 3e2\r\n\r\n4 5 6\r\n")
            .positions == kTwoOfPts);
  CHECK(read_pts_text("0\n").positions.empty());
}

TEST_CASE("a PTS file of several scans has a number of points before each") {
  const auto cloud = read_pts_text("1\n1 -2.5 3e2 5\n1\n4 5 6 7\n");
  CHECK(cloud.positions == kTwoOfPts);
  CHECK(cloud.info.declared_points == 2u);
  CHECK(cloud.info.remarks.empty());
}

TEST_CASE("a text named pts without a count is read as XYZ") {
  CHECK(read_pts_text("1 -2.5 3e2\n4 5 6\n").positions == kTwoOfPts);
  CHECK(read_pts_text("z,y,x\n3e2,-2.5,1\n6,5,4\n").positions == kTwoOfPts);
}

TEST_CASE("the columns of a PTS file can be chosen") {
  ReaderScratch scratch;
  const PointReadOptions columns{{"2", "3", "4"}, true};
  const auto path = scratch.write("a.pts", "1\n9 1 -2.5 3e2\n1\n9 4 5 6\n");
  const auto reader = open_point_file(path, columns);
  CHECK(reader->info().text_table);
  CHECK(read_all(*reader).positions == kTwoOfPts);
  const std::string numbered = "3\n1 5.5 6.5 7\n2 5.5 6.5 8\n3 5.5 6.5 9\n";
  CHECK_THAT(refusal_of_pts(numbered), Contains("the point's number"));
}

TEST_CASE("a PTS file with fewer or more points than declared is refused with its line") {
  CHECK_THAT(refusal_of_pts("3\n1 2 3 4 5\n4 5 6 7 8\n"),
             Contains("2 points") && Contains("expected 3 as line 1 declares"));
  CHECK_THAT(refusal_of_pts("1\n1 2 3\n4 5 6\n"), Contains("line 3") && Contains("more than"));
  CHECK_THAT(refusal_of_pts("1\n1 2 3\n2\n4 5 6 7 8 9\n"), Contains("as line 3 declares"));
  CHECK_THAT(refusal_of_pts("2\n1 2 3\n7\n4 5 6\n"), Contains("line 3") && Contains("1 of the 2"));
  CHECK_THAT(refusal_of_pts("18446744073709551615\n1 2 3\n"), Contains("too short"));
  CHECK_THAT(refusal_of_pts("2\n1 2 3 4\n1 2 3"), Contains("3 of 4 values"));
}
