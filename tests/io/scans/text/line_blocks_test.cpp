#include <catch2/catch.hpp>
#include <random>
#include <string>
#include <vector>

#include "io/scans/text/point_blocks.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Matchers::Contains;

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

TEST_CASE("blocks have the lines of their text, each once") {
  const ReaderScratch scratch;
  std::mt19937 random(7);
  constexpr std::size_t kBlock = LineBlocks::kBlockBytes, kLongest = InputBuffer::kLongestLine;
  const std::size_t most_of_line[] = {3, 100, kLongest};
  std::vector<std::string> texts{"", "a", "a\n", "\n", std::string(kBlock, '\n')};
  // The line break stands right before, at, and right behind the end of a block.
  for (std::size_t extra : {0, 1, 2}) {
    std::string text;
    while (text.size() + kLongest < kBlock) text += std::string(999, 'x') + "\r\n";
    text += std::string(kBlock - 2 - text.size() + extra, 'y') + "\n";
    texts.push_back(text + "z\nw");
  }
  for (const std::size_t most : most_of_line) {
    std::string text;
    while (text.size() < 5 * kBlock) {
      text += std::string(random() % (most + 1), static_cast<char>('a' + random() % 26)) + "\n";
    }
    texts.push_back(text);
    texts.push_back(text + "open");
  }
  for (const std::string& text : texts) {
    const auto path = scratch.write("a.txt", text);
    CHECK((lines_in_blocks(path) == lines_in_turn(path)));
  }
}

TEST_CASE("a line that is too long is too long in its block") {
  const ReaderScratch scratch;
  constexpr std::size_t kBlock = LineBlocks::kBlockBytes, kLongest = InputBuffer::kLongestLine;
  for (const std::size_t before : {std::size_t{0}, kBlock - 4, kBlock}) {
    std::string text;
    while (text.size() < before) text += "ab\n";
    for (const std::size_t length : {kLongest + 1, kLongest + 2000, 2 * kBlock}) {
      const std::string longer = text + std::string(length, 'x') + "\nend\n";
      const auto lines = lines_in_blocks(scratch.write("a.txt", longer));
      REQUIRE_FALSE(lines.empty());
      CHECK(lines.back() == "too long");
    }
    const auto path = scratch.write("a.txt", text + std::string(kLongest, 'x') + "\nend\n");
    CHECK((lines_in_blocks(path) == lines_in_turn(path)));
  }
}
