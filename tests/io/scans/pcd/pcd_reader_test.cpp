#include "io/scans/pcd/pcd_reader.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "support/bytes/pcd_bytes.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Matchers::Contains;

namespace {

/// Reads a file, and again after a rewind, and checks that both agree.
ReadCloud read_twice(const std::string& bytes) {
  ReaderScratch scratch;
  const auto reader = open_point_file(scratch.write("a.pcd", bytes));
  const ReadCloud first = read_all(*reader);
  reader->rewind();
  const ReadCloud second = read_all(*reader);
  CHECK(first.size() == second.size());
  CHECK(first.info.remarks.size() == second.info.remarks.size());
  return first;
}

std::vector<Vec3> points_of(const std::string& bytes) { return read_twice(bytes).positions; }

std::string refusal_of_pcd(const std::string& bytes) {
  ReaderScratch scratch;
  const auto path = scratch.write("a.pcd", bytes);
  const std::string refusal = refusal_of(path);
  CHECK_THAT(refusal, Contains(path.string()));
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
  CHECK(points_of(file + std::string(4000, '\0')).size() == 2);
  CHECK(points_of(file + "\n").size() == 2);
  CHECK_THAT(refusal_of_pcd(file + "more"), Contains("4 bytes behind the last of 2 points"));
  CHECK_THAT(refusal_of_pcd(file + std::string(70'000, '\0')), Contains("expected the end"));
  CHECK_THAT(refusal_of_pcd(header.build("ascii") + "1 2 3\n4 5 6\n7 8 9\n"),
             Contains("line 14") && Contains("more than the 2 points"));
}

TEST_CASE("places of an organised cloud without a point are absent") {
  PcdHeaderText header;
  header.width = "1";
  header.height = "3";
  header.points = "3";
  ReaderScratch scratch;
  const auto reader =
      open_point_file(scratch.write("a.pcd", header.build("ascii") + "nan 1 2\n1 2 3\ninf 1 2\n"));
  PointBatch batch;
  REQUIRE(reader->read(batch));
  CHECK(batch.absent == std::vector<std::uint32_t>{0});
  CHECK(std::isnan(batch.positions[0].z));
  CHECK_FALSE(reader->read(batch));
  REQUIRE(reader->info().remarks.size() == 2);
  const Message& remark = reader->info().remarks[1];
  CHECK(remark.severity == Message::Severity::kNote);
  CHECK(remark.code == "absent-points");
  CHECK_THAT(remark.text, Contains("1 of 3"));

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
  CHECK(remark.code == "pcd-viewpoint");
  CHECK_THAT(remark.text, Contains("(10, 20, -3)") && Contains("90 degrees"));
  REQUIRE(remark.numbers.size() == 4);
  CHECK(remark.numbers[3].second == Approx(90));
  REQUIRE(cloud.info.origins.size() == 1);
  CHECK(cloud.info.origins[0].origin == Vec3{10, 20, -3});
  for (const char* none : {"0 0 0 1 0 0 0", "0 0 0 -1 0 0 0", "0 0 0 0 0 0 0"}) {
    header.viewpoint = none;
    const CloudInfo info = read_twice(header.build("ascii") + "1 2 3\n4 5 6\n").info;
    REQUIRE(info.remarks.size() == 1);
    CHECK(info.remarks[0].severity == Message::Severity::kNote);
    CHECK(info.remarks[0].code == "pcd-default-viewpoint");
    CHECK(info.origins.empty());
  }
}

TEST_CASE("a malformed PCD header is refused with its line") {
  const auto refusal = [](std::string PcdHeaderText::*member, const std::string& value) {
    PcdHeaderText header;
    header.*member = value;
    return refusal_of_header(header);
  };
  CHECK_THAT(refusal(&PcdHeaderText::fields, "x y h"), Contains("named z"));
  CHECK_THAT(refusal(&PcdHeaderText::fields, "x y z x"), Contains("line 4"));
  CHECK_THAT(refusal(&PcdHeaderText::fields, "x y z z"), Contains("SIZE"));
  CHECK_THAT(refusal(&PcdHeaderText::size, "4 4 3"), Contains("line 4") && Contains("SIZE 3"));
  CHECK_THAT(refusal(&PcdHeaderText::size, "4 4 2"), Contains("TYPE F"));
  CHECK_THAT(refusal(&PcdHeaderText::type, "F F f"), Contains("I, U or F"));
  CHECK_THAT(refusal(&PcdHeaderText::count, "1 1 0"), Contains("named z"));
  CHECK_THAT(refusal(&PcdHeaderText::count, "1 1 99999"), Contains("COUNT 99999"));
  CHECK_THAT(refusal(&PcdHeaderText::count, "1 60000 1"), Contains("65536 bytes"));
  CHECK_THAT(refusal(&PcdHeaderText::width, "-2"), Contains("whole number"));
  CHECK_THAT(refusal(&PcdHeaderText::width, "4294967296"), Contains("above"));
  CHECK_THAT(refusal(&PcdHeaderText::height, "3"), Contains("expected WIDTH times HEIGHT, 6"));
  CHECK_THAT(refusal(&PcdHeaderText::viewpoint, "0 0 0 1 0 0"), Contains("seven numbers"));
  CHECK_THAT(refusal(&PcdHeaderText::viewpoint, "0 0 0 nan 0 0 0"), Contains("seven numbers"));
  CHECK_THAT(refusal_of_pcd("1 2 3\n4 5 6\n"), Contains("line 1") && Contains("FIELDS"));
  CHECK_THAT(refusal_of_pcd("DATA ascii\n1 2 3\n"), Contains("no FIELDS"));
  CHECK_THAT(refusal_of_pcd("FIELDS x y z\nDATA ascii\n"), Contains("POINTS"));
  CHECK_THAT(refusal_of_pcd("FIELDS x y z\nHEIGHT 1\nPOINTS 1\nDATA ascii\n"), Contains("HEIGHT"));
  CHECK_THAT(refusal_of_pcd(PcdHeaderText().build("zip")), Contains("binary_compressed"));
}

TEST_CASE("a line of an ascii PCD that is no point is refused") {
  const std::string header = PcdHeaderText().build("ascii");
  for (const char* line : {"1 2", "1 2 3 4", "1 2 three", "1 2 3x", "1,2,3,"}) {
    INFO(line);
    CHECK_THAT(refusal_of_pcd(header + "1.25 2.25 3.25\n" + line + "\n"), Contains("line 13"));
  }
  CHECK_THAT(refusal_of_pcd(header + "1 2 3\n"), Contains("with 1 points") || Contains("ends at"));
  PcdHeaderText many;
  many.width = many.points = "4000000000";
  CHECK_THAT(refusal_of_header(many), Contains("expected 4000000000 points"));
  CHECK_THAT(refusal_of_pcd(many.build("binary") + "abc"), Contains("within point 0"));
}
