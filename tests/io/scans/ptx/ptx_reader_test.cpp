#include "io/scans/ptx/ptx_reader.hpp"

#include <cmath>

#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const std::string kAxes = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
const std::string kIdentity = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";

/// The header's lines for a quarter turn about z, x to y, and then a move by (10, 20, 30).
const std::string kTurned =
    "10 20 30\n0 1 0\n-1 0 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n10 20 30 1\n";

ReadCloud read_ptx_text(const std::string& text, const std::string& name = "a.ptx") {
  ScratchFolder scratch;
  return read_all(scratch.write(name, text));
}

std::string refusal_of_ptx(const std::string& text) {
  ScratchFolder scratch;
  const auto path = scratch.write("a.ptx", text);
  const std::string refusal = refusal_of(path);
  check_says(refusal, path.string());
  return refusal;
}

const Message* find(const ReadCloud& cloud, const std::string& code) {
  for (const Message& remark : cloud.info.remarks) {
    if (remark.code == code) return &remark;
  }
  return nullptr;
}

}  // namespace

TEST_CASE("a scan is placed by its matrix, points are rows") {
  const auto cloud = read_ptx_text("1\n2\n" + kTurned + "1 2 3 0.5\n4 5 6 0.5 1 2 3\n");
  check_equal(cloud.positions, {{8, 21, 33}, {5, 24, 36}});
  CHECK(cloud.info.remarks.empty());
}

TEST_CASE("several scans follow each other, each with its matrix, 0 0 0 is no point") {
  const std::string text = "1\n2\n" + kAxes + kIdentity + "0 0 0 0.5 0 0 0\n1 2 3 0.5 0 0 0\n" +
                           "2\n1\n" + kTurned + "1 2 3 0.5\n0 0.0 -0 0\n";
  ScratchFolder scratch;
  const auto reader = open_point_file(scratch.write("a.ptx", text));
  for (int pass = 0; pass < 2; ++pass) {
    PointBatch batch;  // of one scan
    REQUIRE(reader->read(batch));
    REQUIRE(batch.size() == 2);
    check_equal(batch.absent, {0});
    CHECK(std::isnan(batch.positions[0].x));
    CHECK(batch.positions[1] == Vec3{1, 2, 3});
    REQUIRE(reader->read(batch));
    REQUIRE(batch.size() == 2);
    check_equal(batch.absent, {1});
    CHECK(batch.positions[0] == Vec3{8, 21, 33});
    CHECK_FALSE(reader->read(batch));
    CHECK(reader->info().remarks.empty());
    reader->rewind();
  }
}

TEST_CASE("a PTX file with Windows line breaks, a mark, blank lines and no last line break") {
  std::string text =
      "\xEF\xBB\xBF"
      "1\n1\n" +
      kTurned + "1 2 3 0.5\n\n";
  std::string windows;
  for (const char c : text) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
  check_equal(read_ptx_text(windows).positions, {{8, 21, 33}});
  const auto cloud = read_ptx_text("1\n1\n" + kTurned + "1 2 3 0.5");
  check_equal(cloud.positions, {{8, 21, 33}});
  CHECK(cloud.info.remarks.empty());
  check_says(refusal_of_ptx("2\n1\n" + kTurned + "1 2 3 0.5\n1 2 3"), "3 of 4 values");
  check_says(refusal_of_ptx("1\n1\n" + kTurned + "1 2 3 0."), "within a number");
}

TEST_CASE("a PTX scan without points is read") {
  check_equal(read_ptx_text("0\n5\n" + kTurned).size(), 0);
  check_equal(read_ptx_text("0\n5\n" + kTurned + "1\n1\n" + kTurned + "1 2 3\n").size(), 1);
}

TEST_CASE(
    "a matrix that scales or mirrors is applied with a warning, one without inverse refused") {
  const std::string scaled = "1 0 0 0\n0 1 0 0\n0 0 2 0\n0 0 0 1\n";
  const auto cloud = read_ptx_text("1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 2\n" + scaled + "1 2 3 1\n");
  check_equal(cloud.positions, {{1, 2, 6}});
  const Message* warning = find(cloud, "scan-not-rigid");
  REQUIRE(warning);
  CHECK(warning->severity == Message::Severity::kWarning);
  check_says(warning->text, "1 of 1 scans ... from 1 to 2");
  CHECK(find(read_ptx_text("1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 -1\n1 0 0 0\n0 1 0 0\n0 0 -1 0\n"
                           "0 0 0 1\n1 2 3 1\n"),
             "scan-not-rigid"));
  check_says(refusal_of_ptx("1\n1\n" + kAxes + "1 0 0 0\n0 1 0 0\n0 0 0 0\n0 0 0 1\n1 2 3\n"),
             "line 10 ... invertible");
}

TEST_CASE("axes that contradict the matrix are warned of with the largest difference") {
  const auto cloud = read_ptx_text("1\n1\n" + kTurned + "1 2 3 1\n1\n1\n3 4 0\n1 0 0\n0 1 0\n" +
                                   "0 0.5 1\n" + kIdentity + "1 2 3 1\n");
  const Message* warning = find(cloud, "scan-axes-contradict");
  REQUIRE(warning);
  CHECK(warning->severity == Message::Severity::kWarning);
  check_says(warning->text, "1 of 2 scans ... line 12");
  REQUIRE(warning->numbers.size() == 4);
  check_equal(warning->numbers[2].second, 5);
  check_equal(warning->numbers[3].second, 0.5);
  CHECK(cloud.positions[1] == Vec3{1, 2, 3});
}

TEST_CASE("a malformed PTX file is refused with its line") {
  const std::string head = "1\n2\n" + kAxes + kIdentity;
  check_says(refusal_of_ptx("1 2 3\n"), "line 1 ... columns");
  check_says(refusal_of_ptx("1\n2\n0 0\n"), "line 3 ... position");
  check_says(refusal_of_ptx("1\n2\n0 0 0\n1 0 0 0\n"), "line 4 ... axis");
  check_says(refusal_of_ptx("1\n2\n" + kAxes + "1 0 0\n"), "line 7");
  check_says(refusal_of_ptx("1\n2\n" + kAxes + "1 0 0 5\n0 1 0 6\n0 0 1 7\n0 0 0 1\n1 2 3\n"),
             "line 7 ... translation");
  check_says(refusal_of_ptx("1\n2\n" + kAxes + "1 0 nan 0\n"), "line 7");
  check_says(refusal_of_ptx("1\n2\n" + kAxes + "1 0 0 0\n0 1 0 0\n"), "ends after");
  CHECK_THAT(refusal_of_ptx(head + "1 2 3 4\n"), Contains("1 of 2 points") || Contains("short"));
  check_says(refusal_of_ptx(head + "1 2 3 4\n1 2\n"), "line 12 ... 1 of 2");
  check_says(refusal_of_ptx("1\n1\n" + kAxes + kIdentity + "1 2 3 4\n4 5 6 7\n"),
             "line 12 ... columns");
  check_says(refusal_of_ptx(head + "1 2 3 4\n1\n1\n" + kAxes + kIdentity + "1 2 3\n"),
             "line 12 ... 1 of 2 points of the scan at line 1");
  check_says(refusal_of_ptx("4294967295\n4294967295\n" + kAxes + kIdentity + "1 2 3\n"),
             "too short");
  check_says(refusal_of_ptx("4294967296\n1\n"), "line 1");
  CHECK_THAT(refusal_of_ptx("# nothing\n"), Contains("holds no scan") || Contains("columns"));
}

TEST_CASE("the count lines tell PTX, PTS and XYZ, whatever the name") {
  const std::string text = "1\n1\n" + kTurned + "1 2 3 0.5\n";
  for (const char* name : {"a.pts", "a.xyz", "a.txt", "a.csv", "a.asc"}) {
    const auto cloud = read_ptx_text(text, name);
    check_equal(cloud.positions, {{8, 21, 33}});
    const Message* note = find(cloud, "named-otherwise");
    REQUIRE(note);
    check_says(note->text, std::string(name) + " ... PTX");
  }
  const auto pts = read_ptx_text("1\n1 2 3\n", "a.ptx");
  check_equal(pts.positions, {{1, 2, 3}});
  REQUIRE(find(pts, "named-otherwise"));
  CHECK_FALSE(find(read_ptx_text(text), "named-otherwise"));
}

namespace {

ReadCloud read_pts_text(const std::string& text) {
  ScratchFolder scratch;
  const auto reader = open_point_file(scratch.write("a.pts", text));
  const ReadCloud first = read_all(*reader);
  reader->rewind();
  const ReadCloud second = read_all(*reader);
  CHECK(first.positions == second.positions);
  check_equal(first.info.remarks.size(), second.info.remarks.size());
  return first;
}

std::string refusal_of_pts(const std::string& text) {
  ScratchFolder scratch;
  const auto path = scratch.write("a.pts", text);
  const std::string refusal = refusal_of(path);
  check_says(refusal, path.string());
  return refusal;
}

const std::vector<Vec3> kTwoOfPts{{1, -2.5, 3e2}, {4, 5, 6}};

}  // namespace

TEST_CASE("a PTS file: its number of points, then lines with anything behind x y z") {
  const auto cloud = read_pts_text("2\n1 -2.5 3e2 -1613 52 70 64\n4 5 6 7 8 9 10\n");
  CHECK(cloud.positions == kTwoOfPts);
  check_equal(cloud.info.declared_points, 2u);
  CHECK(cloud.info.remarks.empty());
  CHECK(read_pts_text("\xEF\xBB\xBF"
                      "2 \r\n1 -2.5 3e2\r\n\r\n4 5 6\r\n")
            .positions == kTwoOfPts);
  CHECK(read_pts_text("0\n").positions.empty());
}

TEST_CASE("a PTS file of several scans has a number of points before each") {
  const auto cloud = read_pts_text("1\n1 -2.5 3e2 5\n1\n4 5 6 7\n");
  CHECK(cloud.positions == kTwoOfPts);
  check_equal(cloud.info.declared_points, 2u);
  CHECK(cloud.info.remarks.empty());
}

TEST_CASE("a text named pts without a count is read as XYZ") {
  CHECK(read_pts_text("1 -2.5 3e2\n4 5 6\n").positions == kTwoOfPts);
  CHECK(read_pts_text("z,y,x\n3e2,-2.5,1\n6,5,4\n").positions == kTwoOfPts);
}

TEST_CASE("the columns of a PTS file can be chosen") {
  ScratchFolder scratch;
  const PointReadOptions columns{{"2", "3", "4"}, true};
  const auto path = scratch.write("a.pts", "1\n9 1 -2.5 3e2\n1\n9 4 5 6\n");
  const auto reader = open_point_file(path, columns);
  CHECK(reader->info().text_table);
  CHECK(read_all(*reader).positions == kTwoOfPts);
  const std::string numbered = "3\n1 5.5 6.5 7\n2 5.5 6.5 8\n3 5.5 6.5 9\n";
  check_says(refusal_of_pts(numbered), "the point's number");
}

TEST_CASE("a PTS file with fewer or more points than declared is refused with its line") {
  check_says(refusal_of_pts("3\n1 2 3 4 5\n4 5 6 7 8\n"),
             "2 points ... expected 3 as line 1 declares");
  check_says(refusal_of_pts("1\n1 2 3\n4 5 6\n"), "line 3 ... more than");
  check_says(refusal_of_pts("1\n1 2 3\n2\n4 5 6 7 8 9\n"), "as line 3 declares");
  check_says(refusal_of_pts("2\n1 2 3\n7\n4 5 6\n"), "line 3 ... 1 of the 2");
  check_says(refusal_of_pts("18446744073709551615\n1 2 3\n"), "too short");
  check_says(refusal_of_pts("2\n1 2 3 4\n1 2 3"), "3 of 4 values");
}
