// Compressed PCD; text and binary are in tests/formats/pcd.case.
#include <random>

#include "io/scans/pcd/lzf_stream.hpp"
#include "support/bytes/pcd_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A text with runs, far matches and noise.
std::string some_text(std::size_t size) {
  std::mt19937 random(7);
  std::string text;
  while (text.size() < size) {
    if (text.size() > 9000 && random() % 3 == 0) {
      text += text.substr(text.size() - 1 - random() % 8900, 3 + random() % 600);
    } else if (random() % 3 == 0) {
      text += std::string(random() % 700, static_cast<char>(random()));
    } else {
      for (auto n = random() % 90; n > 0; --n) text += static_cast<char>(random());
    }
  }
  text.resize(size);
  return text;
}

std::string decoded(const std::string& packed, std::uint64_t bytes) {
  const ScratchFolder scratch;
  const File file = File::open_regular(scratch.write("a", "12" + packed + "3"));
  LzfStream stream(file, 2, 2 + packed.size(), bytes);
  std::string out(bytes, '\0');
  stream.read(std::as_writable_bytes(std::span(out)));
  stream.check_end();
  return out;
}

}  // namespace

TEST_CASE("LZF is decoded: literals, matches of every length, far ones, overlapping ones") {
  for (const std::size_t size : {1, 2, 31, 32, 33, 264, 265, 8192, 8193, 65536, 300'000}) {
    INFO(size);
    const std::string text = some_text(size);
    CHECK(decoded(lzf(text), size) == text);
    CHECK(decoded(lzf(std::string(size, 'r')), size) == std::string(size, 'r'));
  }
}

TEST_CASE("a copy of an LZF stream goes on from where its original stands") {
  const std::string text = some_text(200'000), packed = lzf(text);
  const ScratchFolder scratch;
  const File file = File::open_regular(scratch.write("a", packed));
  LzfStream stream(file, 0, packed.size(), text.size());
  for (const std::uint64_t at : {0, 5, 70'000, 131'000, 199'000}) {
    stream.skip(at - stream.position());
    LzfStream copy = stream;
    std::string out(1000, '\0');
    copy.read(std::as_writable_bytes(std::span(out)));
    CHECK(out == text.substr(at, 1000));
    CHECK(stream.position() == at);
  }
}

TEST_CASE("damaged LZF is refused") {
  const std::tuple<std::string, int, const char*> rows[] = {
      {"\x20\x05", 3, "a match 6 bytes back"},
      {std::string("\0a\x20\1", 4), 4, "a match 2 bytes back"},
      {"\4abcd", 5, "ends after 0 bytes"},
      {"\3abcd", 5, "ends after 4 bytes"},
      {"\3abcd", 3, "holds more than the 3 bytes"},
      {"\3abcd\3", 4, "expected its end"}};
  for (const auto& [packed, bytes, words] : rows) {
    check_refused<InputError>([&] { decoded(packed, static_cast<std::uint64_t>(bytes)); }, words);
  }
}

TEST_CASE("a compressed PCD has its columns one after the other, without padding fields") {
  PcdHeaderText header;
  header.fields = "z _ n y x";
  header.size = "8 1 4 2 4";
  header.type = "F U F I F";
  header.count = "1 2 2 1 1";
  const std::string columns =
      raw(0.1, 6.0, 7.F, 7.F, 8.F, 8.F, std::int16_t{-2}, std::int16_t{5}, 1.5F, 4.F);
  const ScratchFolder scratch;
  const auto reader = open_point_file(
      scratch.write("a.pcd", header.build("binary_compressed") + compressed(columns)));
  for (int pass = 0; pass < 2; ++pass) {
    check_equal(read_all(*reader).positions, {{1.5, -2, 0.1}, {4, 5, 6}});
    reader->rewind();
  }
}

TEST_CASE("a compressed PCD whose sizes contradict the header or the file is refused") {
  const std::string columns = raw(1.F, 4.F, 2.F, 5.F, 3.F, 6.F), packed = lzf(columns);
  const auto size = static_cast<std::uint32_t>(packed.size());
  const std::pair<std::string, const char*> rows[] = {
      {compressed(columns), ""},
      {compressed(columns) + std::string(4000, '\0'), ""},
      {compressed(columns) + "x", "1 bytes behind the last"},
      {"1234", "8 bytes"},
      {raw(size + 1, 24U) + packed, "compressed data up to byte"},
      {raw(size, 23U) + packed, "12 bytes for each"},
      {raw(size, 36U) + packed, "for 2 points"},
      {raw(size - 1, 24U) + packed.substr(0, size - 1), "ends after"},
      {raw(0U, 24U), "ends after 0 bytes"}};
  const ScratchFolder scratch;
  for (const auto& [body, words] : rows) {
    check_says(
        refusal_of(scratch.write("a.pcd", PcdHeaderText().build("binary_compressed") + body)),
        words);
  }
}
