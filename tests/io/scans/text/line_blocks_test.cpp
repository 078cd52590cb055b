#include <algorithm>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "io/scans/text/point_blocks.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

InputBuffer input_of(const std::filesystem::path& path) {
  return {File::open_regular(path), InputBuffer::Access::kSeek};
}

std::vector<std::string> lines_in_turn(const std::filesystem::path& path) {
  InputBuffer input = input_of(path);
  std::vector<std::string> lines;
  for (std::string_view line; input.next_line(line);) lines.emplace_back(line);
  return lines;
}

/// The lines of all blocks; the last one is "too long" where a line is.
std::vector<std::string> lines_in_blocks(const std::filesystem::path& path) {
  const InputBuffer input = input_of(path);
  const LineBlocks blocks(input);
  std::vector<std::string> lines;
  std::vector<char> room;
  for (std::size_t i = 0; i < blocks.count(); ++i) {
    const bool all = each_line(blocks.read(i, room), [&](std::string_view line) {
      lines.emplace_back(line);
      return true;
    });
    if (all) continue;
    lines.emplace_back("too long");
    return lines;
  }
  return lines;
}

}  // namespace

TEST_CASE("lines end with LF, CR LF or CR, also at the borders of blocks and buffers") {
  const ScratchFolder scratch;
  std::mt19937 random(7);
  constexpr std::size_t kBlock = LineBlocks::kBlockBytes, kLongest = InputBuffer::kLongestLine;
  std::vector<std::string> texts{"", "a", "a\n", "\n", std::string(kBlock, '\n')};
  // The line break stands right before, at, and right behind the end of a block.
  for (std::size_t extra : {0, 1, 2}) {
    std::string text;
    while (text.size() + kLongest < kBlock) text += std::string(999, 'x') + "\n";
    text += std::string(kBlock - 2 - text.size() + extra, 'y') + "\n";
    texts.push_back(text + "z\nw");
  }
  for (const std::size_t most : {std::size_t{3}, std::size_t{100}, kLongest}) {
    std::string text;
    while (text.size() < 5 * kBlock) {
      text += std::string(random() % (most + 1), static_cast<char>('a' + random() % 26)) + "\n";
    }
    texts.push_back(text);
    texts.push_back(text + "open");
  }
  for (const std::string& text : texts) {
    std::vector<std::string> expected;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) expected.push_back(line);
    for (const std::vector<std::string>& breaks : std::vector<std::vector<std::string>>{
             {"\n"}, {"\r\n"}, {"\r"}, {"\n", "\r\n", "\r", "\r\n"}}) {
      std::string written;
      std::size_t lines = 0;
      for (const char c : text) {
        written += c == '\n' ? breaks[lines++ % breaks.size()] : std::string(1, c);
      }
      // An empty line between LF and CR LF, or CR and LF, would change what the breaks are.
      if (breaks.size() > 1 && text.find("\n\n") != std::string::npos) continue;
      const auto path = scratch.write("a.txt", written);
      CHECK((lines_in_turn(path) == expected));
      CHECK((lines_in_blocks(path) == expected));
    }
  }
}

TEST_CASE("a line that is too long is too long in its block") {
  const ScratchFolder scratch;
  constexpr std::size_t kBlock = LineBlocks::kBlockBytes, kLongest = InputBuffer::kLongestLine;
  for (const std::size_t before : {std::size_t{0}, kBlock - 4, kBlock}) {
    std::string text;
    while (text.size() < before) text += "ab\n";
    for (const std::size_t length : {kLongest + 1, kLongest + 2000, 2 * kBlock}) {
      const std::string longer = text + std::string(length, 'x') + "\nend\n";
      const auto lines = lines_in_blocks(scratch.write("a.txt", longer));
      REQUIRE_FALSE(lines.empty());
      check_equal(lines.back(), "too long");
    }
    const auto path = scratch.write("a.txt", text + std::string(kLongest, 'x') + "\nend\n");
    CHECK((lines_in_blocks(path) == lines_in_turn(path)));
  }
}

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
  const ScratchFolder scratch;
  check_points(scratch.write("a.xyz", rows(0, kPoints)));
  check_points(scratch.write("a.xyz", rows(0, kPoints, "\r")));
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
  const ScratchFolder scratch;
  const std::string many = rows(0, 70'000);
  const std::array<std::string, 3> files[] = {
      {"a.xyz", "#\n" + many + "1 2 x\n" + rows(0, 20'000), "line 70002: \"1 2 x\""},
      {"a.ply", ply(many + "1 2\n" + rows(0, 9), 80'000),
       "line 70008: expected a number for property"},
      {"a.ply", ply(many, 70'001), "ends after line 70007 with 70000 of element"},
      {"a.ply", ply(rows(0, 70'001), 70'000), "is more than the header declares"},
      {"a.pts", "69999\n" + many, "line 70001: more than the 69999 points that line 1 declares"},
      {"a.pts", "70001\n" + many, "ends after line 70001 with 70000 points; expected 70001"},
      {"a.xyz",
       rows(0, 30'000, "\r") + rows(0, 30'000, "\r\n") + rows(0, 10'000) + "1 2 x\r" + rows(0, 9),
       "line 70001: \"1 2 x\""},
      {"a.xyz", many + "1 2 3 " + std::string(70'000, '4') + "\n",
       "line 70001: is longer than 65536 bytes"}};
  for (const auto& [name, text, words] : files) {
    check_says(refusal_of(scratch.write(name, text)), words);
  }
}

TEST_CASE("a long text that may be cut is warned of by the number of its last line") {
  const ScratchFolder scratch;
  const auto reader = open_point_file(scratch.write("a.xyz", rows(0, 70'000, " 5\n") + row_of(1)));
  check_equal(read_all(*reader).positions.size(), 70'001);
  REQUIRE(reader->info().remarks.size() == 1);
  check_equal(reader->info().remarks[0].code, "cut-text");
  check_equal(reader->info().remarks[0].numbers.at(0).second, 70'001);
}
