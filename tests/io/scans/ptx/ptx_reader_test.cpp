#include "io/scans/ptx/ptx_reader.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Matchers::Contains;

namespace {

const std::string kAxes = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
const std::string kIdentity = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";

/// The header's lines for a quarter turn about z, x to y, and then a move by (10, 20, 30).
const std::string kTurned =
    "10 20 30\n0 1 0\n-1 0 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n10 20 30 1\n";

ReadCloud read_ptx_text(const std::string& text, const std::string& name = "a.ptx") {
  ReaderScratch scratch;
  return read_all(scratch.write(name, text));
}

std::string refusal_of_ptx(const std::string& text) {
  ReaderScratch scratch;
  const auto path = scratch.write("a.ptx", text);
  const std::string refusal = refusal_of(path);
  CHECK_THAT(refusal, Contains(path.string()));
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
  CHECK(cloud.positions == std::vector<Vec3>{{8, 21, 33}, {5, 24, 36}});
  REQUIRE(cloud.info.remarks.size() == 1);
  CHECK(cloud.info.remarks[0].severity == Message::Severity::kNote);
  CHECK_THAT(cloud.info.remarks[0].text, Contains("1 scan") && Contains("0 of 2 records"));
}

TEST_CASE("several scans follow each other, each with its matrix, 0 0 0 is no point") {
  const std::string text = "1\n2\n" + kAxes + kIdentity + "0 0 0 0.5 0 0 0\n1 2 3 0.5 0 0 0\n" +
                           "2\n1\n" + kTurned + "1 2 3 0.5\n0 0.0 -0 0\n";
  ReaderScratch scratch;
  const auto reader = open_point_file(scratch.write("a.ptx", text));
  for (int pass = 0; pass < 2; ++pass) {
    PointBatch batch;
    REQUIRE(reader->read(batch));
    REQUIRE(batch.size() == 4);
    CHECK(batch.absent == std::vector<std::uint32_t>{0, 3});
    CHECK(std::isnan(batch.positions[0].x));
    CHECK(batch.positions[1] == Vec3{1, 2, 3});
    CHECK(batch.positions[2] == Vec3{8, 21, 33});
    CHECK_FALSE(reader->read(batch));
    REQUIRE(reader->info().remarks.size() == 1);
    CHECK_THAT(reader->info().remarks[0].text, Contains("2 scans") && Contains("2 of 4 records"));
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
  CHECK(read_ptx_text(windows).positions == std::vector<Vec3>{{8, 21, 33}});
  const auto cloud = read_ptx_text("1\n1\n" + kTurned + "1 2 3 0.5");
  CHECK(cloud.positions == std::vector<Vec3>{{8, 21, 33}});
  CHECK(cloud.info.remarks.size() == 1);  // that the scans are placed
  CHECK_THAT(refusal_of_ptx("2\n1\n" + kTurned + "1 2 3 0.5\n1 2 3"), Contains("3 of 4 values"));
  CHECK_THAT(refusal_of_ptx("1\n1\n" + kTurned + "1 2 3 0."), Contains("within a number"));
}

TEST_CASE("a PTX scan without points is read") {
  CHECK(read_ptx_text("0\n5\n" + kTurned).size() == 0);
  CHECK(read_ptx_text("0\n5\n" + kTurned + "1\n1\n" + kTurned + "1 2 3\n").size() == 1);
}

TEST_CASE(
    "a matrix that scales or mirrors is applied with a warning, one without inverse refused") {
  const std::string scaled = "1 0 0 0\n0 1 0 0\n0 0 2 0\n0 0 0 1\n";
  const auto cloud = read_ptx_text("1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 2\n" + scaled + "1 2 3 1\n");
  CHECK(cloud.positions == std::vector<Vec3>{{1, 2, 6}});
  const Message* warning = find(cloud, "scan-not-rigid");
  REQUIRE(warning);
  CHECK(warning->severity == Message::Severity::kWarning);
  CHECK_THAT(warning->text, Contains("1 of 1 scans") && Contains("from 1 to 2"));
  CHECK(find(read_ptx_text("1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 -1\n1 0 0 0\n0 1 0 0\n0 0 -1 0\n"
                           "0 0 0 1\n1 2 3 1\n"),
             "scan-not-rigid"));
  CHECK_THAT(refusal_of_ptx("1\n1\n" + kAxes + "1 0 0 0\n0 1 0 0\n0 0 0 0\n0 0 0 1\n1 2 3\n"),
             Contains("invertible") && Contains("line 10"));
}

TEST_CASE("axes that contradict the matrix are warned of with the largest difference") {
  const auto cloud = read_ptx_text("1\n1\n" + kTurned + "1 2 3 1\n1\n1\n3 4 0\n1 0 0\n0 1 0\n" +
                                   "0 0.5 1\n" + kIdentity + "1 2 3 1\n");
  const Message* warning = find(cloud, "scan-axes-contradict");
  REQUIRE(warning);
  CHECK(warning->severity == Message::Severity::kWarning);
  CHECK_THAT(warning->text, Contains("1 of 2 scans") && Contains("line 12"));
  REQUIRE(warning->numbers.size() == 4);
  CHECK(warning->numbers[2].second == 5);
  CHECK(warning->numbers[3].second == 0.5);
  CHECK(cloud.positions[1] == Vec3{1, 2, 3});
}

TEST_CASE("a malformed PTX file is refused with its line") {
  const std::string head = "1\n2\n" + kAxes + kIdentity;
  CHECK_THAT(refusal_of_ptx("1 2 3\n"), Contains("line 1") && Contains("columns"));
  CHECK_THAT(refusal_of_ptx("1\n2\n0 0\n"), Contains("line 3") && Contains("position"));
  CHECK_THAT(refusal_of_ptx("1\n2\n0 0 0\n1 0 0 0\n"), Contains("line 4") && Contains("axis"));
  CHECK_THAT(refusal_of_ptx("1\n2\n" + kAxes + "1 0 0\n"), Contains("line 7"));
  CHECK_THAT(refusal_of_ptx("1\n2\n" + kAxes + "1 0 0 5\n0 1 0 6\n0 0 1 7\n0 0 0 1\n1 2 3\n"),
             Contains("line 7") && Contains("translation"));
  CHECK_THAT(refusal_of_ptx("1\n2\n" + kAxes + "1 0 nan 0\n"), Contains("line 7"));
  CHECK_THAT(refusal_of_ptx("1\n2\n" + kAxes + "1 0 0 0\n0 1 0 0\n"), Contains("ends after"));
  CHECK_THAT(refusal_of_ptx(head + "1 2 3 4\n"), Contains("1 of 2 points") || Contains("short"));
  CHECK_THAT(refusal_of_ptx(head + "1 2 3 4\n1 2\n"), Contains("line 12") && Contains("1 of 2"));
  CHECK_THAT(refusal_of_ptx("1\n1\n" + kAxes + kIdentity + "1 2 3 4\n4 5 6 7\n"),
             Contains("line 12") && Contains("columns"));
  CHECK_THAT(refusal_of_ptx(head + "1 2 3 4\n1\n1\n" + kAxes + kIdentity + "1 2 3\n"),
             Contains("line 12") && Contains("1 of 2 points of the scan at line 1"));
  CHECK_THAT(refusal_of_ptx("4294967295\n4294967295\n" + kAxes + kIdentity + "1 2 3\n"),
             Contains("too short"));
  CHECK_THAT(refusal_of_ptx("4294967296\n1\n"), Contains("line 1"));
  CHECK_THAT(refusal_of_ptx("# nothing\n"), Contains("holds no scan") || Contains("columns"));
}

TEST_CASE("the count lines tell PTX, PTS and XYZ, whatever the name") {
  const std::string text = "1\n1\n" + kTurned + "1 2 3 0.5\n";
  for (const char* name : {"a.pts", "a.xyz", "a.txt", "a.csv", "a.asc"}) {
    const auto cloud = read_ptx_text(text, name);
    CHECK(cloud.positions == std::vector<Vec3>{{8, 21, 33}});
    const Message* note = find(cloud, "named-otherwise");
    REQUIRE(note);
    CHECK_THAT(note->text, Contains(name) && Contains("PTX"));
  }
  const auto pts = read_ptx_text("1\n1 2 3\n", "a.ptx");
  CHECK(pts.positions == std::vector<Vec3>{{1, 2, 3}});
  REQUIRE(find(pts, "named-otherwise"));
  CHECK_FALSE(find(read_ptx_text(text), "named-otherwise"));
}
