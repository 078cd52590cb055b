#include "io/scans/las/las_writer.hpp"

#include <sstream>
#include <stdexcept>

#include "clearway/error.hpp"
#include "support/bytes/written_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;
using Quanta = std::vector<std::array<std::int32_t, 3>>;

namespace {

const Quanta kPoints{{-5, 7, 2000000000}, {1, -2000000000, 3}, {0, 0, 0}};
const QuantumBox kBounds{{-5, -2000000000, 0}, {1, 7, 2000000000}};
const Quantisation kQuantisation{{0.001, 0.002, 0.0001}, {100, -200, 0.5}};
const std::string kWkt = "LOCAL_CS[\"site\",UNIT[\"metre\",1]]";

/// The file of these points with declared totals. That of kPoints, whose totals are those, is the
/// same where they are not declared.
WrittenBytes written(const LasFormat& format, const Quanta& points,
                     const std::vector<std::uint32_t>& poses = {}) {
  const auto write = [&](const std::optional<LasTotals>& declared) {
    const File file = nameless_file();
    LasWriter writer(file, format, declared);
    const FieldValues field = std::span<const std::uint32_t>(poses);
    writer.write(points, std::span(&field, format.fields.size()));
    writer.finish();
    return WrittenBytes(file);
  };
  const WrittenBytes bytes = write(LasTotals{points.size(), kBounds, {points.size()}});
  if (points == kPoints) CHECK(bytes.all() == write({}).all());
  return bytes;
}

LasFormat format_of(std::uint64_t points, const std::string& crs_wkt = {},
                    const std::vector<PointField>& fields = {}) {
  return LasFormat::of_points(kQuantisation, points, crs_wkt, fields);
}

/// Checks fields of the file: "24:1=2" is that the byte at 24 is 2, "26:32=OTHER" that the text of
/// 32 bytes at 26 is OTHER, "4:20=" that 20 bytes at 4 are zero.
void check_fields(const WrittenBytes& bytes, const std::string& fields, std::size_t first = 0) {
  std::istringstream in(fields);
  for (std::string field; in >> field;) {
    INFO(field);
    const std::size_t at = first + std::stoul(field);
    const auto size = static_cast<unsigned>(std::stoul(field.substr(field.find(':') + 1)));
    const std::string value = field.substr(field.find('=') + 1);
    if (value.empty()) {
      CHECK(bytes.zero(at, size));
    } else if (std::isdigit(value[0])) {
      CHECK(std::to_string(bytes.number(at, size)) == value);
    } else {
      CHECK(bytes.text(at, size) == value);
    }
  }
}

/// Checks scale, offset and bounds, and that the file has the size that its header declares, but
/// for extended records.
void check_whole(const WrittenBytes& bytes, std::uint64_t behind = 0) {
  for (int k = 0; k < 3; ++k) {
    CHECK(bytes.at<double>(131 + 8 * k) == kQuantisation.scale[k]);
    CHECK(bytes.at<double>(155 + 8 * k) == kQuantisation.offset[k]);
    CHECK(bytes.at<double>(179 + 16 * k) == coordinate(kQuantisation, k, kBounds.hi[k]));
    CHECK(bytes.at<double>(187 + 16 * k) == coordinate(kQuantisation, k, kBounds.lo[k]));
  }
  const std::uint64_t points =
      bytes.number(25, 1) == 4 ? bytes.number(247, 8) : bytes.number(107, 4);
  check_equal(bytes.size(), bytes.number(96, 4) + points * bytes.number(105, 2) + behind);
}

void check_points(const WrittenBytes& bytes, const Quanta& points) {
  const std::uint64_t first = bytes.number(96, 4), step = bytes.number(105, 2);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (bytes.at<std::array<std::int32_t, 3>>(first + step * i) != points[i]) FAIL("point " << i);
  }
}

}  // namespace

TEST_CASE("LAS 1.2 with point format 0, field by field") {
  const auto bytes = written(format_of(3), kPoints);
  check_fields(bytes,
               "0:4=LASF 4:20= 24:1=1 25:1=2 26:32=OTHER 58:32=Clearway 90:4= 94:2=227 96:4=227 "
               "100:4=0 104:1=0 105:2=20 107:4=3 111:4=3 115:16=");
  check_whole(bytes);
  check_points(bytes, kPoints);
  for (const std::size_t at : {227, 247, 267}) check_fields(bytes, "12:2=0 14:1=9 15:5=", at);
}

TEST_CASE("LAS 1.4 with a CRS, field by field") {
  const auto bytes = written(format_of(3, kWkt), kPoints);
  const std::string size = std::to_string(kWkt.size() + 1);
  check_fields(bytes,
               "6:2=16 25:1=4 94:2=375 100:4=1 104:1=6 105:2=30 107:24= 227:20= 247:8=3 255:8=3 "
               "263:112= 377:16=LASF_Projection 393:2=2112 395:2=" +
                   size);
  check_equal(bytes.number(96, 4), 375 + 54 + kWkt.size() + 1);
  CHECK(bytes.all().substr(429, kWkt.size() + 1) == kWkt + '\0');
  check_whole(bytes);
}

TEST_CASE("LAS point format 6 with first poses, field by field") {
  const std::vector<std::uint32_t> poses{0, 4000000000u, 17};
  const auto bytes = written(format_of(3, {}, {{"first_pose"}}), kPoints, poses);
  check_fields(bytes,
               "96:4=621 100:4=1 105:2=34 377:16=LASF_Spec 393:2=4 395:2=192 429:2= 431:1=5 "
               "432:1=0 433:32=first_pose 465:124=");
  check_points(bytes, kPoints);
  for (std::size_t i = 0; i < 3; ++i) {
    check_fields(bytes, "12:2=0 14:1=17 15:15= 30:4=" + std::to_string(poses[i]), 621 + 34 * i);
  }
  check_whole(bytes);
}

TEST_CASE("a CRS and first poses together declare both records") {
  const auto bytes = written(format_of(1, kWkt, {{"first_pose"}}), {kPoints[1]}, {9});
  check_fields(bytes, "100:4=2");
  check_fields(bytes, "2:16=LASF_Spec", 375 + 54 + kWkt.size() + 1);
  check_whole(bytes);
}

TEST_CASE("a CRS too long for a variable length record goes behind the points") {
  std::string wkt(65535, 'w');
  const auto bytes = written(format_of(3, wkt), kPoints);
  const std::size_t start = bytes.number(235, 8);
  check_fields(bytes, "100:4=0 243:4=1");
  check_fields(bytes, "2:16=LASF_Projection 18:2=2112 20:8=65536", start);
  CHECK(bytes.all().substr(start + 60) == wkt + '\0');
  check_whole(bytes, 60 + 65536);
  wkt.pop_back();
  check_fields(written(format_of(3, wkt), kPoints), "100:4=1");
}

TEST_CASE("a count beyond 32 bits is declared by LAS 1.4") {
  const File file = nameless_file();
  const std::uint64_t points = 0x100000000;
  LasWriter writer(file, format_of(points), LasTotals{points, kBounds, {points}});
  writer.write(Quanta(60000, {1, 2, 3}));  // more than the buffer: the header is written
  check_fields(WrittenBytes(file), "25:1=4 107:4=0 247:8=4294967296");
}

TEST_CASE("many points through the buffer arrive in order") {
  Quanta points;
  for (std::int32_t i = 0; i < 200000; ++i) points.push_back({i, -i, 2 * i});
  const auto bytes = written(format_of(points.size()), points);
  check_whole(bytes);
  check_points(bytes, points);
}

TEST_CASE("LAS without points has zero bounds") {
  const auto bytes = written(format_of(0), {});
  check_equal(bytes.size(), 227);
  check_fields(bytes, "25:1=2 179:48=");
}

TEST_CASE("another number of LAS points than promised is a programmer's mistake") {
  const File file = nameless_file();
  LasWriter writer(file, format_of(2), LasTotals{2, kBounds, {2}});
  writer.write(Quanta{kPoints[0]});
  CHECK_THROWS_AS(writer.finish(), std::logic_error);
  const std::vector<std::uint32_t> poses{1, 2, 3};
  const FieldValues field = std::span<const std::uint32_t>(poses);
  CHECK_THROWS_AS(writer.write(kPoints, std::span(&field, 1)), std::logic_error);
}

TEST_CASE("a full disk is a resource error") {
  const File full = File::create("/dev/full");
  LasWriter writer(full, format_of(1));
  writer.write(Quanta{kPoints[0]});
  CHECK_THROWS_AS(writer.finish(), ResourceError);
}
