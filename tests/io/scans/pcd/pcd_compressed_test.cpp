#include <catch2/catch.hpp>
#include <random>

#include "io/scans/pcd/lzf_stream.hpp"
#include "io/scans/pcd/pcd_reader.hpp"
#include "support/bytes/pcd_bytes.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Matchers::Contains;

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
  ReaderScratch scratch;
  const File file = File::open_regular(scratch.write("a", "12" + packed + "3"));
  LzfStream stream(file, 2, 2 + packed.size(), bytes);
  std::string out(bytes, '\0');
  stream.read(std::as_writable_bytes(std::span(out)));
  stream.check_end();
  return out;
}

std::string refusal_of_lzf(const std::string& packed, std::uint64_t bytes) {
  try {
    decoded(packed, bytes);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

PcdHeaderText header_of(std::size_t points) {
  PcdHeaderText header;
  header.width = header.points = std::to_string(points);
  return header;
}

std::string refusal_of_body(const std::string& body) {
  ReaderScratch scratch;
  return refusal_of(scratch.write("a.pcd", header_of(2).build("binary_compressed") + body));
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
  const std::string text = some_text(200'000);
  const std::string packed = lzf(text);
  ReaderScratch scratch;
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
  CHECK_THAT(refusal_of_lzf("\x20\x05", 3), Contains("a match 6 bytes back"));
  CHECK_THAT(refusal_of_lzf(std::string("\0a\x20\1", 4), 4), Contains("a match 2 bytes back"));
  CHECK_THAT(refusal_of_lzf("\4abcd", 5), Contains("ends after 0 bytes"));
  CHECK_THAT(refusal_of_lzf("\3abcd", 5), Contains("ends after 4 bytes"));
  CHECK_THAT(refusal_of_lzf("\3abcd", 3), Contains("holds more than the 3 bytes"));
  CHECK_THAT(refusal_of_lzf("\3abcd\3", 4), Contains("expected its end"));
}

TEST_CASE("a compressed PCD: the columns one after the other, without padding fields") {
  PcdHeaderText header;
  header.fields = "z _ n y x";
  header.size = "8 1 4 2 4";
  header.type = "F U F I F";
  header.count = "1 2 2 1 1";
  const std::string columns =
      raw(0.1, 6.0, 7.F, 7.F, 8.F, 8.F, std::int16_t{-2}, std::int16_t{5}, 1.5F, 4.F);
  ReaderScratch scratch;
  const auto reader = open_point_file(
      scratch.write("a.pcd", header.build("binary_compressed") + compressed(columns)));
  for (int pass = 0; pass < 2; ++pass) {
    CHECK(read_all(*reader).positions == std::vector<Vec3>{{1.5, -2, 0.1}, {4, 5, 6}});
    reader->rewind();
  }
}

TEST_CASE("a compressed PCD of several batches, twice") {
  constexpr std::size_t kPoints = 150'000;
  std::string columns;
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < kPoints; ++i) {
      columns += raw(static_cast<float>(axis * 1000) + static_cast<float>(i % 5000) / 8);
    }
  }
  ReaderScratch scratch;
  const auto reader = open_point_file(
      scratch.write("a.pcd", header_of(kPoints).build("binary_compressed") + compressed(columns)));
  for (int pass = 0; pass < 2; ++pass) {
    const auto points = read_all(*reader).positions;
    REQUIRE(points.size() == kPoints);
    bool equal = true;
    for (std::size_t i = 0; i < kPoints; ++i) {
      const double part = static_cast<double>(i % 5000) / 8;
      equal = equal && points[i] == Vec3{part, 1000 + part, 2000 + part};
    }
    CHECK(equal);
    reader->rewind();
  }
}

TEST_CASE("a compressed PCD whose sizes contradict the header or the file is refused") {
  const std::string columns = raw(1.F, 4.F, 2.F, 5.F, 3.F, 6.F);
  const std::string packed = lzf(columns);
  const auto size = static_cast<std::uint32_t>(packed.size());
  CHECK(refusal_of_body(compressed(columns)).empty());
  CHECK(refusal_of_body(compressed(columns) + std::string(4000, '\0')).empty());
  CHECK_THAT(refusal_of_body(compressed(columns) + "x"), Contains("1 bytes behind the last"));
  CHECK_THAT(refusal_of_body("1234"), Contains("8 bytes"));
  CHECK_THAT(refusal_of_body(raw(size + 1, 24U) + packed), Contains("compressed data up to byte"));
  CHECK_THAT(refusal_of_body(raw(size, 23U) + packed), Contains("12 bytes for each"));
  CHECK_THAT(refusal_of_body(raw(size, 36U) + packed), Contains("for 2 points"));
  CHECK_THAT(refusal_of_body(raw(size - 1, 24U) + packed.substr(0, size - 1)),
             Contains("ends after"));
  CHECK_THAT(refusal_of_body(raw(0U, 24U)), Contains("ends after 0 bytes"));
}
