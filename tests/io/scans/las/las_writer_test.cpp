#include "io/scans/las/las_writer.hpp"

#include <stdexcept>
#include <vector>

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

test::WrittenBytes written(const LasHeader& header, const Quanta& points,
                           const std::vector<std::uint32_t>& poses = {}) {
  const File file = test::nameless_file();
  LasWriter writer(file, header);
  const FieldValues field = std::span<const std::uint32_t>(poses);
  writer.write(points, std::span(&field, header.fields.size()));
  writer.finish();
  return test::WrittenBytes(file);
}

LasHeader header_of(std::uint64_t points) {
  return {.quantisation = kQuantisation, .points = points, .bounds = kBounds};
}

void check_geometry(const test::WrittenBytes& bytes) {
  for (int k = 0; k < 3; ++k) {
    CHECK(bytes.at<double>(131 + 8 * k) == kQuantisation.scale[k]);
    CHECK(bytes.at<double>(155 + 8 * k) == kQuantisation.offset[k]);
    CHECK(bytes.at<double>(179 + 16 * k) == coordinate(kQuantisation, k, kBounds.hi[k]));
    CHECK(bytes.at<double>(187 + 16 * k) == coordinate(kQuantisation, k, kBounds.lo[k]));
  }
}

/// The size that a file's own header declares, EVLRs aside.
std::uint64_t declared_bytes(const test::WrittenBytes& bytes) {
  const bool version_14 = bytes.at<std::uint8_t>(25) == 4;
  const std::uint64_t points =
      version_14 ? bytes.at<std::uint64_t>(247) : bytes.at<std::uint32_t>(107);
  return bytes.at<std::uint32_t>(96) + points * bytes.at<std::uint16_t>(105);
}

}  // namespace

TEST_CASE("LAS 1.2 header, field by field") {
  const auto bytes = written(header_of(3), kPoints);
  check_equal(bytes.text(0, 4), "LASF");
  CHECK(bytes.zero(4, 20));
  check_equal(bytes.at<std::uint8_t>(24), 1);
  check_equal(bytes.at<std::uint8_t>(25), 2);
  check_equal(bytes.text(26, 32), "OTHER");
  check_equal(bytes.text(58, 32), "Clearway");
  CHECK(bytes.zero(90, 4));
  check_equal(bytes.at<std::uint16_t>(94), 227);
  check_equal(bytes.at<std::uint32_t>(96), 227);
  check_equal(bytes.at<std::uint32_t>(100), 0);
  check_equal(bytes.at<std::uint8_t>(104), 0);
  check_equal(bytes.at<std::uint16_t>(105), 20);
  check_equal(bytes.at<std::uint32_t>(107), 3);
  check_equal(bytes.at<std::uint32_t>(111), 3);
  CHECK(bytes.zero(115, 16));
  check_geometry(bytes);
  check_equal(bytes.size(), declared_bytes(bytes));
}

TEST_CASE("LAS point format 0, field by field") {
  const auto bytes = written(header_of(3), kPoints);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t at = 227 + 20 * i;
    for (std::size_t k = 0; k < 3; ++k) CHECK(bytes.at<std::int32_t>(at + 4 * k) == kPoints[i][k]);
    check_equal(bytes.at<std::uint16_t>(at + 12), 0);
    CHECK(bytes.at<std::uint8_t>(at + 14) == 0b001001);
    CHECK(bytes.zero(at + 15, 5));
  }
}

TEST_CASE("LAS 1.4 with a CRS, field by field") {
  LasHeader header = header_of(3);
  header.crs_wkt = kWkt;
  const auto bytes = written(header, kPoints);
  const auto wkt_bytes = static_cast<std::uint32_t>(kWkt.size() + 1);
  check_equal(bytes.at<std::uint16_t>(6), 16);
  check_equal(bytes.at<std::uint8_t>(25), 4);
  check_equal(bytes.at<std::uint16_t>(94), 375);
  CHECK(bytes.at<std::uint32_t>(96) == 375 + 54 + wkt_bytes);
  check_equal(bytes.at<std::uint32_t>(100), 1);
  check_equal(bytes.at<std::uint8_t>(104), 6);
  check_equal(bytes.at<std::uint16_t>(105), 30);
  CHECK(bytes.zero(107, 24));
  check_geometry(bytes);
  CHECK(bytes.zero(227, 20));
  check_equal(bytes.at<std::uint64_t>(247), 3);
  check_equal(bytes.at<std::uint64_t>(255), 3);
  CHECK(bytes.zero(263, 112));
  check_equal(bytes.text(377, 16), "LASF_Projection");
  check_equal(bytes.at<std::uint16_t>(393), 2112);
  CHECK(bytes.at<std::uint16_t>(395) == wkt_bytes);
  CHECK(bytes.text(429, wkt_bytes) == kWkt);
  CHECK(bytes.zero(429 + kWkt.size(), 1));
  check_equal(bytes.size(), declared_bytes(bytes));
}

TEST_CASE("LAS point format 6 with first poses, field by field") {
  LasHeader header = header_of(3);
  header.fields = {{"first_pose"}};
  const std::vector<std::uint32_t> poses{0, 4000000000u, 17};
  const auto bytes = written(header, kPoints, poses);
  REQUIRE(bytes.at<std::uint32_t>(96) == 375 + 54 + 192);
  check_equal(bytes.at<std::uint32_t>(100), 1);
  check_equal(bytes.at<std::uint16_t>(105), 34);
  check_equal(bytes.text(377, 16), "LASF_Spec");
  check_equal(bytes.at<std::uint16_t>(393), 4);
  check_equal(bytes.at<std::uint16_t>(395), 192);
  CHECK(bytes.zero(429, 2));
  check_equal(bytes.at<std::uint8_t>(431), 5);
  check_equal(bytes.at<std::uint8_t>(432), 0);
  check_equal(bytes.text(433, 32), "first_pose");
  CHECK(bytes.zero(465, 124));
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t at = 621 + 34 * i;
    for (std::size_t k = 0; k < 3; ++k) CHECK(bytes.at<std::int32_t>(at + 4 * k) == kPoints[i][k]);
    check_equal(bytes.at<std::uint16_t>(at + 12), 0);
    check_equal(bytes.at<std::uint8_t>(at + 14), 0x11);
    CHECK(bytes.zero(at + 15, 15));
    CHECK(bytes.at<std::uint32_t>(at + 30) == poses[i]);
  }
  check_equal(bytes.size(), declared_bytes(bytes));
}

TEST_CASE("a CRS and first poses together declare both records") {
  LasHeader header = header_of(1);
  header.fields = {{"first_pose"}};
  header.crs_wkt = kWkt;
  const auto bytes = written(header, {kPoints[1]}, {9});
  check_equal(bytes.at<std::uint32_t>(100), 2);
  const std::size_t second = 375 + 54 + kWkt.size() + 1;
  check_equal(bytes.text(second + 2, 16), "LASF_Spec");
  check_equal(bytes.size(), declared_bytes(bytes));
}

TEST_CASE("a CRS too long for a variable length record goes behind the points") {
  LasHeader header = header_of(3);
  header.crs_wkt = std::string(65535, 'w');
  const auto bytes = written(header, kPoints);
  check_equal(bytes.at<std::uint32_t>(100), 0);
  check_equal(bytes.at<std::uint32_t>(243), 1);
  const auto start = bytes.at<std::uint64_t>(235);
  REQUIRE(start == declared_bytes(bytes));
  check_equal(bytes.text(start + 2, 16), "LASF_Projection");
  check_equal(bytes.at<std::uint16_t>(start + 18), 2112);
  check_equal(bytes.at<std::uint64_t>(start + 20), 65536);
  CHECK(bytes.text(start + 60, 65536) == header.crs_wkt);
  check_equal(bytes.size(), start + 60 + 65536);
  header.crs_wkt.pop_back();
  check_equal(written(header, kPoints).at<std::uint32_t>(100), 1);
}

TEST_CASE("a count beyond 32 bits is declared by LAS 1.4") {
  LasHeader header = header_of(0x100000000);
  const File file = test::nameless_file();
  LasWriter writer(file, header);
  writer.write(Quanta(60000, {1, 2, 3}));  // more than the buffer: the header is written
  const test::WrittenBytes bytes(file);
  check_equal(bytes.at<std::uint8_t>(25), 4);
  check_equal(bytes.at<std::uint32_t>(107), 0);
  check_equal(bytes.at<std::uint64_t>(247), 0x100000000);
  check_equal(written(header_of(0), {}).at<std::uint8_t>(25), 2);
}

TEST_CASE("many points through the buffer arrive in order") {
  Quanta points;
  for (std::int32_t i = 0; i < 200000; ++i) points.push_back({i, -i, 2 * i});
  const auto bytes = written(header_of(points.size()), points);
  REQUIRE(bytes.size() == declared_bytes(bytes));
  bool equal = true;
  for (std::size_t i = 0; i < points.size(); ++i) {
    equal = equal && bytes.at<std::array<std::int32_t, 3>>(227 + 20 * i) == points[i];
  }
  CHECK(equal);
}

TEST_CASE("LAS without points has zero bounds") {
  const auto bytes = written(header_of(0), {});
  check_equal(bytes.size(), 227);
  CHECK(bytes.zero(179, 48));
}

TEST_CASE("another number of LAS points than promised is a programmer's mistake") {
  const File file = test::nameless_file();
  LasWriter writer(file, header_of(2));
  writer.write(Quanta{kPoints[0]});
  CHECK_THROWS_AS(writer.finish(), std::logic_error);
  const std::vector<std::uint32_t> poses{1, 2, 3};
  const FieldValues field = std::span<const std::uint32_t>(poses);
  CHECK_THROWS_AS(writer.write(kPoints, std::span(&field, 1)), std::logic_error);
}

TEST_CASE("a full disk is a resource error") {
  const File full = File::create("/dev/full");
  LasWriter writer(full, header_of(1));
  writer.write(Quanta{kPoints[0]});
  CHECK_THROWS_AS(writer.finish(), ResourceError);
}
