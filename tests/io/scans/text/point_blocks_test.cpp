#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Matchers::Contains;

namespace {

constexpr std::size_t kPoints = 90'000;  // some 8 blocks of lines, and more than a batch

Vec3 point_of(std::size_t i) {
  const auto number = static_cast<double>(i);
  return {number / 8, -number, number * 1e3};
}

std::string row_of(std::size_t i) {
  const Vec3 p = point_of(i);
  return std::to_string(p.x) + " " + std::to_string(p.y) + "\t" + std::to_string(p.z);
}

std::string rows(std::size_t from, std::size_t to, const std::string& behind = "\n") {
  std::string text;
  for (std::size_t i = from; i < to; ++i) text += row_of(i) + behind;
  return text;
}

void check_points(const std::filesystem::path& path) {
  const auto reader = open_point_file(path);
  for (int i = 0; i < 2; ++i) {
    const auto points = read_all(*reader).positions;
    REQUIRE(points.size() == kPoints);
    std::size_t same = 0;
    for (std::size_t k = 0; k < kPoints; ++k) same += points[k] == point_of(k) ? 1 : 0;
    CHECK(same == kPoints);
    reader->rewind();
  }
}

std::string ply(const std::string& vertices, std::size_t count, const std::string& more = "") {
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(count) +
         "\nproperty double x\nproperty double y\nproperty double z\n" + more + "end_header\n" +
         vertices;
}

}  // namespace

TEST_CASE("a long text has its points in the order of its lines") {
  const ReaderScratch scratch;
  check_points(scratch.write("a.xyz", rows(0, kPoints)));
  check_points(scratch.write("a.xyz", "# one\n" + rows(0, 9, " 7 8\r\n") + "\n// more\n" +
                                          rows(9, 70'000, " 7 8\n") + "\n#\n" +
                                          rows(70'000, kPoints, " 7 8\n")));
  check_points(scratch.write("a.xyz", rows(0, kPoints - 1) + row_of(kPoints - 1)));
  check_points(scratch.write("a.pts", std::to_string(kPoints) + "\n" + rows(0, kPoints)));
  check_points(
      scratch.write("a.pts", "40000\n" + rows(0, 40'000) + "\n50000\n" + rows(40'000, kPoints)));
  check_points(scratch.write("a.ply", ply(rows(0, kPoints), kPoints)));
  check_points(scratch.write(
      "a.ply", ply(rows(0, 50'000, " \r\n") + "\n" + rows(50'000, kPoints) + "3 0 1 2\n3 2 1 0\n",
                   kPoints, "element face 2\nproperty list uchar int n\n")));
}

TEST_CASE("a line in the middle of a long text is refused by its number") {
  const ReaderScratch scratch;
  const std::string damaged = "#\n" + rows(0, 70'000) + "1 2 x\n" + rows(0, 20'000);
  CHECK_THAT(refusal_of(scratch.write("a.xyz", damaged)), Contains("line 70002: \"1 2 x\""));
  CHECK_THAT(
      refusal_of(scratch.write("a.ply", ply(rows(0, 70'000) + "1 2\n" + rows(0, 9), 80'000))),
      Contains("line 70008: expected a number for property"));
  CHECK_THAT(refusal_of(scratch.write("a.ply", ply(rows(0, 70'000), 70'001))),
             Contains("ends after line 70007 with 70000 of element"));
  CHECK_THAT(refusal_of(scratch.write("a.ply", ply(rows(0, 70'001), 70'000))),
             Contains("is more than the header declares"));
  CHECK_THAT(refusal_of(scratch.write("a.pts", "69999\n" + rows(0, 70'000))),
             Contains("line 70001: more than the 69999 points that line 1 declares"));
  CHECK_THAT(refusal_of(scratch.write("a.pts", "70001\n" + rows(0, 70'000))),
             Contains("ends after line 70001 with 70000 points; expected 70001"));
  const std::string long_line = rows(0, 70'000) + "1 2 3 " + std::string(70'000, '4') + "\n";
  CHECK_THAT(refusal_of(scratch.write("a.xyz", long_line)),
             Contains("line 70001: is longer than 65536 bytes"));
}

TEST_CASE("a long text that may be cut is warned of by the number of its last line") {
  const ReaderScratch scratch;
  const auto reader = open_point_file(scratch.write("a.xyz", rows(0, 70'000, " 5\n") + row_of(1)));
  CHECK(read_all(*reader).positions.size() == 70'001);
  REQUIRE(reader->info().remarks.size() == 1);
  CHECK(reader->info().remarks[0].code == "cut-text");
  CHECK(reader->info().remarks[0].numbers.at(0).second == 70'001);
}
