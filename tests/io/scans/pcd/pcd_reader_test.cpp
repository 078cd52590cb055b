#include "io/scans/pcd/pcd_reader.hpp"

#include <cmath>
#include <random>

#include "io/scans/pcd/lzf_stream.hpp"
#include "support/bytes/pcd_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Reads a file, and again after a rewind, and checks that both agree.
ReadCloud read_twice(const std::string& bytes) {
  ScratchFolder scratch;
  const auto reader = open_point_file(scratch.write("a.pcd", bytes));
  const ReadCloud first = read_all(*reader);
  reader->rewind();
  const ReadCloud second = read_all(*reader);
  check_equal(first.size(), second.size());
  check_equal(first.info.remarks.size(), second.info.remarks.size());
  return first;
}

std::vector<Vec3> points_of(const std::string& bytes) { return read_twice(bytes).positions; }

std::string refusal_of_pcd(const std::string& bytes) {
  ScratchFolder scratch;
  const auto path = scratch.write("a.pcd", bytes);
  const std::string refusal = refusal_of(path);
  check_says(refusal, path.string());
  return refusal;
}

std::string refusal_of_header(const PcdHeaderText& header) {
  return refusal_of_pcd(header.build("ascii") + "1 2 3\n4 5 6\n");
}

/// A header with x and z as float and double, a padding of two bytes, two numbers of another field,
/// and y as int16.
PcdHeaderText mixed_fields() {
  PcdHeaderText header;
  header.fields = "z _ n y x";
  header.size = "8 1 4 2 4";
  header.type = "F U F I F";
  header.count = "1 2 2 1 1";
  return header;
}

const std::vector<Vec3> kTwo{{1.5, -2, 0.1}, {4, 5, 6}};

}  // namespace

TEST_CASE("an ascii PCD: numbers as written, fields in any order, blanks or commas") {
  PcdHeaderText header;
  CHECK(points_of(header.build("ascii") + "1.5 -2 0.1\n4 5 6\n") == kTwo);
  CHECK(points_of(header.build("ascii") + "1.5,-2,0.1\r\n\r\n4,5,6\r\n") == kTwo);
  CHECK(points_of(header.build("ascii") + " 1.5\t-2\t0.1 \n4\t5\t6\n\n") == kTwo);
  CHECK(points_of(mixed_fields().build("ascii") + "0.1 0 0 7 7 -2 1.5\n6 0 0 nan nan 5 4\n") ==
        kTwo);
  header.fields = "X Y Z";
  CHECK(points_of(header.build("ascii") + "1.5 -2 0.1\n4 5 6\n") == kTwo);
}

TEST_CASE("PCD headers of older versions: COLUMNS, no types, no WIDTH") {
  const std::string text = "1.5 -2 0.1\n4 5 6\n";
  CHECK(points_of("COLUMNS x y z\nPOINTS 2\nDATA ascii\n" + text) == kTwo);
  CHECK(points_of("VERSION .5\nFIELDS x y z\nWIDTH 2\nDATA ascii\n" + text) == kTwo);
  CHECK(points_of("# c\n\nFIELDS x y z\nWIDTH 1\nHEIGHT 2\nDATA ascii\n" + text) == kTwo);
}

TEST_CASE("a binary PCD: every number type, padding fields, several elements") {
  CHECK(points_of(mixed_fields().build("binary") +
                  raw(0.1, '\1', '\1', 7.F, 7.F, std::int16_t{-2}, 1.5F) +
                  raw(6.0, '\1', '\1', 7.F, 7.F, std::int16_t{5}, 4.F)) == kTwo);
  PcdHeaderText header;
  header.width = header.points = "1";
  header.size = "1 2 4";
  header.type = "U U U";
  CHECK(points_of(header.build("binary") + raw('\xFF', std::uint16_t{65535}, 4294967295U)) ==
        std::vector<Vec3>{{255, 65535, 4294967295.0}});
  header.type = "I I I";
  CHECK(points_of(header.build("binary") + raw('\xFF', std::uint16_t{65535}, 4294967295U)) ==
        std::vector<Vec3>{{-1, -1, -1}});
  header.size = "8 8 8";
  header.type = "I U F";
  CHECK(points_of(header.build("binary") + raw(std::int64_t{-5}, std::uint64_t{1} << 40, 0.25)) ==
        std::vector<Vec3>{{-5, 0x1p40, 0.25}});
}

TEST_CASE("what PCL leaves behind binary data is no error, more data is") {
  const PcdHeaderText header;
  const std::string file = header.build("binary") + raw(1.5F, -2.F, 0.5F, 4.F, 5.F, 6.F);
  check_equal(points_of(file + std::string(4000, '\0')).size(), 2);
  check_equal(points_of(file + "\n").size(), 2);
  check_says(refusal_of_pcd(file + "more"), "4 bytes behind the last of 2 points");
  check_says(refusal_of_pcd(file + std::string(70'000, '\0')), "expected the end");
  check_says(refusal_of_pcd(header.build("ascii") + "1 2 3\n4 5 6\n7 8 9\n"),
             "line 14 ... more than the 2 points");
}

TEST_CASE("places of an organised cloud without a point are absent") {
  PcdHeaderText header;
  header.width = "1";
  header.height = "3";
  header.points = "3";
  ScratchFolder scratch;
  const auto reader =
      open_point_file(scratch.write("a.pcd", header.build("ascii") + "nan 1 2\n1 2 3\ninf 1 2\n"));
  PointBatch batch;
  REQUIRE(reader->read(batch));
  check_equal(batch.absent, {0});
  CHECK(std::isnan(batch.positions[0].z));
  CHECK_FALSE(reader->read(batch));
  CHECK(reader->info().remarks.empty());

  header.width = "3";
  header.height = "1";
  const auto unorganised =
      open_point_file(scratch.write("b.pcd", header.build("ascii") + "nan 1 2\n1 2 3\n4 5 6\n"));
  REQUIRE(unorganised->read(batch));
  CHECK(batch.absent.empty());
}

TEST_CASE("a VIEWPOINT is not applied, which a warning says with its numbers") {
  PcdHeaderText header;
  header.viewpoint = "10 20 -3 0.7071067811865476 0 0 0.7071067811865476";
  const ReadCloud cloud = read_twice(header.build("ascii") + "1.5 -2 0.1\n4 5 6\n");
  CHECK(cloud.positions == kTwo);
  REQUIRE(cloud.info.remarks.size() == 1);
  const Message& remark = cloud.info.remarks[0];
  CHECK(remark.severity == Message::Severity::kWarning);
  check_equal(remark.code, "pcd-viewpoint");
  check_says(remark.text, "(10, 20, -3) ... 90 degrees");
  REQUIRE(remark.numbers.size() == 4);
  CHECK(remark.numbers[3].second == Approx(90));
  REQUIRE(cloud.info.origins.size() == 1);
  CHECK(cloud.info.origins[0].origin == Vec3{10, 20, -3});
  for (const char* none : {"0 0 0 1 0 0 0", "0 0 0 -1 0 0 0", "0 0 0 0 0 0 0"}) {
    header.viewpoint = none;
    const CloudInfo info = read_twice(header.build("ascii") + "1 2 3\n4 5 6\n").info;
    CHECK(info.remarks.empty());
    CHECK(info.origins.empty());
  }
}

TEST_CASE("a malformed PCD header is refused with its line") {
  const auto refusal = [](std::string PcdHeaderText::*member, const std::string& value) {
    PcdHeaderText header;
    header.*member = value;
    return refusal_of_header(header);
  };
  check_says(refusal(&PcdHeaderText::fields, "x y h"), "named z");
  check_says(refusal(&PcdHeaderText::fields, "x y z x"), "line 4");
  check_says(refusal(&PcdHeaderText::fields, "x y z z"), "SIZE");
  check_says(refusal(&PcdHeaderText::size, "4 4 3"), "line 4 ... SIZE 3");
  check_says(refusal(&PcdHeaderText::size, "4 4 2"), "TYPE F");
  check_says(refusal(&PcdHeaderText::type, "F F f"), "I, U or F");
  check_says(refusal(&PcdHeaderText::count, "1 1 0"), "named z");
  check_says(refusal(&PcdHeaderText::count, "1 1 99999"), "COUNT 99999");
  check_says(refusal(&PcdHeaderText::count, "1 60000 1"), "65536 bytes");
  check_says(refusal(&PcdHeaderText::width, "-2"), "whole number");
  check_says(refusal(&PcdHeaderText::width, "4294967296"), "above");
  check_says(refusal(&PcdHeaderText::height, "3"), "expected WIDTH times HEIGHT, 6");
  check_says(refusal(&PcdHeaderText::viewpoint, "0 0 0 1 0 0"), "seven numbers");
  check_says(refusal(&PcdHeaderText::viewpoint, "0 0 0 nan 0 0 0"), "seven numbers");
  check_says(refusal_of_pcd("1 2 3\n4 5 6\n"), "line 1 ... FIELDS");
  check_says(refusal_of_pcd("DATA ascii\n1 2 3\n"), "no FIELDS");
  check_says(refusal_of_pcd("FIELDS x y z\nDATA ascii\n"), "POINTS");
  check_says(refusal_of_pcd("FIELDS x y z\nHEIGHT 1\nPOINTS 1\nDATA ascii\n"), "HEIGHT");
  check_says(refusal_of_pcd(PcdHeaderText().build("zip")), "binary_compressed");
}

TEST_CASE("a line of an ascii PCD that is no point is refused") {
  const std::string header = PcdHeaderText().build("ascii");
  for (const char* line : {"1 2", "1 2 3 4", "1 2 three", "1 2 3x", "1,2,3,"}) {
    INFO(line);
    check_says(refusal_of_pcd(header + "1.25 2.25 3.25\n" + line + "\n"), "line 13");
  }
  CHECK_THAT(refusal_of_pcd(header + "1 2 3\n"), Contains("with 1 points") || Contains("ends at"));
  PcdHeaderText many;
  many.width = many.points = "4000000000";
  check_says(refusal_of_header(many), "expected 4000000000 points");
  check_says(refusal_of_pcd(many.build("binary") + "abc"), "within point 0");
}

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
  ScratchFolder scratch;
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
  ScratchFolder scratch;
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
  ScratchFolder scratch;
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
  check_says(refusal_of_lzf("\x20\x05", 3), "a match 6 bytes back");
  check_says(refusal_of_lzf(std::string("\0a\x20\1", 4), 4), "a match 2 bytes back");
  check_says(refusal_of_lzf("\4abcd", 5), "ends after 0 bytes");
  check_says(refusal_of_lzf("\3abcd", 5), "ends after 4 bytes");
  check_says(refusal_of_lzf("\3abcd", 3), "holds more than the 3 bytes");
  check_says(refusal_of_lzf("\3abcd\3", 4), "expected its end");
}

TEST_CASE("a compressed PCD: the columns one after the other, without padding fields") {
  PcdHeaderText header;
  header.fields = "z _ n y x";
  header.size = "8 1 4 2 4";
  header.type = "F U F I F";
  header.count = "1 2 2 1 1";
  const std::string columns =
      raw(0.1, 6.0, 7.F, 7.F, 8.F, 8.F, std::int16_t{-2}, std::int16_t{5}, 1.5F, 4.F);
  ScratchFolder scratch;
  const auto reader = open_point_file(
      scratch.write("a.pcd", header.build("binary_compressed") + compressed(columns)));
  for (int pass = 0; pass < 2; ++pass) {
    check_equal(read_all(*reader).positions, {{1.5, -2, 0.1}, {4, 5, 6}});
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
  ScratchFolder scratch;
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
  check_says(refusal_of_body(compressed(columns) + "x"), "1 bytes behind the last");
  check_says(refusal_of_body("1234"), "8 bytes");
  check_says(refusal_of_body(raw(size + 1, 24U) + packed), "compressed data up to byte");
  check_says(refusal_of_body(raw(size, 23U) + packed), "12 bytes for each");
  check_says(refusal_of_body(raw(size, 36U) + packed), "for 2 points");
  check_says(refusal_of_body(raw(size - 1, 24U) + packed.substr(0, size - 1)), "ends after");
  check_says(refusal_of_body(raw(0U, 24U)), "ends after 0 bytes");
}
