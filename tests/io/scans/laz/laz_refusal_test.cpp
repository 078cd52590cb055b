#include <catch2/catch.hpp>
#include <chrono>
#include <limits>

#include "support/bytes/laz/laz_samples.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Matchers::Contains;

namespace {

std::string refusal_of_bytes(const std::string& bytes) {
  ReaderScratch scratch;
  return refusal_of(scratch.write("a.laz", bytes));
}

template <typename Number>
std::string refusal_with(const LazBytes& laz, std::size_t at, Number value) {
  std::string bytes = laz.build();
  LasBytes::put(bytes, at, value);
  return refusal_of_bytes(bytes);
}

/// Where the payload of the LAZ record begins; that record is the last before the points.
std::size_t scheme_of(const LazBytes& laz) { return laz.las.points_offset() + 54; }

/// The place of the chunk table, as the file states it.
std::uint64_t table_of(const LazBytes& laz) {
  std::uint64_t table = 0;
  std::memcpy(&table, laz.build().data() + laz.points_offset(), sizeof table);
  return table;
}

}  // namespace

TEST_CASE("what a LAZ record must not say is refused, with what was expected") {
  const LazBytes laz = laz_bytes(1, 20);
  const std::size_t at = scheme_of(laz);
  const auto refusal = [&](std::size_t field, std::uint16_t value) {
    std::string message = refusal_with(laz, at + field, value);
    CHECK_THAT(message, Contains("a.laz") && Contains("expected"));
    return message;
  };
  CHECK_THAT(refusal(0, 0), Contains("compressor 0"));
  CHECK_THAT(refusal(0, 4), Contains("compressor 4"));
  CHECK_THAT(refusal(0, 3), Contains("POINT10"));
  CHECK_THAT(refusal(2, 1), Contains("coder 1"));
  CHECK_THAT(refusal(32, 2), Contains("2 items"));
  CHECK_THAT(refusal(34, 1), Contains("type 1"));
  CHECK_THAT(refusal(34, 10), Contains("POINT14 of 30 bytes"));
  CHECK_THAT(refusal(36, 21), Contains("POINT10 of 20 bytes"));
  CHECK_THAT(refusal(38, 3), Contains("version 3") && Contains("1 to 2"));
  CHECK_THAT(refusal(40, 8), Contains("RGB12 of 6 bytes"));
  CHECK_THAT(refusal(48, 4), Contains("items of 32 bytes"));
  CHECK_THAT(refusal(46, 7), Contains("GPSTIME11"));
}

TEST_CASE("a LAZ header and its record have to agree") {
  LazBytes laz = laz_bytes(1, 20);
  CHECK_THAT(refusal_with<std::uint8_t>(laz, 104, 1), Contains("ends at byte"));
  laz.las.vlrs = {{"laszip encoded", 22204, "payload"}};
  CHECK_THAT(refusal_of_bytes(laz.las.build()), Contains("byte 104") && Contains("not compressed"));
  laz.las.vlrs.clear();
  CHECK_THAT(refusal_with<std::uint8_t>(laz, 104, 0xC1), Contains("before LASzip 1.0"));
  CHECK(refusal_with<std::uint8_t>(laz, 104, 0x41).empty());
  CHECK_THAT(refusal_with<std::uint8_t>(laz, 104, 0x8B), Contains("point format 11"));
  CHECK_THAT(refusal_with<char>(laz, laz.las.points_offset() + 2, 'x'),
             Contains("laszip encoded") && Contains("byte 104"));
  LazBytes six = laz_bytes(6, 20);
  CHECK_THAT(refusal_with<std::uint8_t>(six, 104, 0x81), Contains("point format 1"));
}

TEST_CASE("a chunk table that disagrees with the header is refused with both numbers") {
  LazBytes laz = laz_bytes(6, 15);
  laz.variable = GENERATE(false, true);
  const auto declared = [&](std::uint64_t points) {
    return refusal_with<std::uint64_t>(laz, 247, points);
  };
  CHECK_THAT(declared(16), Contains("15") || Contains("16"));
  CHECK_THAT(declared(10), Contains("expected 10") && Contains("write the file again"));
  CHECK_THAT(declared(0), Contains("expected 0") && Contains("write the file again"));
  CHECK_THAT(declared(11), Contains("11") || Contains("5 points by its own count, but 1 by the"));
  CHECK_THAT(declared(std::uint64_t{1} << 60), Contains("1152921504606846976"));
}

TEST_CASE("a chunk table in the wrong place, or of what cannot be, is refused") {
  const LazBytes laz = laz_bytes(0, 20);
  const std::size_t pointer = laz.points_offset();
  const std::uint64_t table = table_of(laz), size = laz.build().size();
  const auto moved = [&](std::uint64_t place) {
    std::string message = refusal_with(laz, pointer, place);
    CHECK_THAT(message, Contains("a.laz") && Contains("expected"));
    return message;
  };
  CHECK_THAT(moved(pointer + 7), Contains("chunk table"));
  CHECK_THAT(moved(size), Contains("cut"));
  CHECK_THAT(moved(size - 7), Contains("cut"));
  CHECK_THAT(moved(std::numeric_limits<std::uint64_t>::max() - 1), Contains("cut"));
  moved(table - 1);
  moved(table + 1);
  CHECK_THAT(refusal_with<std::uint32_t>(laz, table, 1), Contains("version 1"));
  CHECK_THAT(refusal_with<std::uint32_t>(laz, table + 4, 0xFFFFFFFF), Contains("4294967295"));
  CHECK_THAT(refusal_with<std::uint32_t>(laz, table + 4, 3), Contains("15 points"));
  CHECK_THAT(refusal_with<std::uint32_t>(laz, table + 4, 5), Contains("chunk 5 of 5"));
}

TEST_CASE("a count below the points of a file without a table is refused") {
  LazBytes laz = laz_bytes(0, 20);
  laz.table = LazBytes::Table::kNone;
  CHECK_THAT(refusal_with<std::uint32_t>(laz, 107, 10),
             Contains("bytes behind the 10 points") && Contains("write the file again"));
  CHECK_THAT(refusal_with<std::uint32_t>(laz, 107, 0), Contains("behind the 0 points"));
  CHECK_THAT(refusal_with<std::uint32_t>(laz, 107, 25), Contains("chunk 5"));
  laz.variable = true;
  CHECK_THAT(refusal_of_bytes(laz.build()), Contains("no chunk table"));
}

TEST_CASE("a damaged chunk is named: the first of several") {
  LazBytes laz = laz_bytes(7, 40);
  std::string bytes = laz.build();
  const std::size_t first = laz.points_offset() + 8;
  // The count of a layered chunk stands behind its first record.
  const std::size_t count = first + laz.las.record_bytes();
  bytes[count] = 4;
  CHECK_THAT(refusal_of_bytes(bytes),
             Contains("a.laz: chunk 1 of 8: ") && Contains("holds 4 points"));
  bytes[count] = 5;
  bytes[count + 4] = static_cast<char>(bytes[count + 4] + 1);
  CHECK_THAT(refusal_of_bytes(bytes), Contains("chunk 1 of 8: its layers have 1 bytes more"));
  bytes[count + 4] = static_cast<char>(bytes[count + 4] - 2);
  CHECK_THAT(refusal_of_bytes(bytes), Contains("chunk 1 of 8: has 1 bytes behind"));
}

TEST_CASE("a chunk of few bytes does not take the time of the points it claims") {
  LazBytes laz = laz_bytes(GENERATE(0u, 6u), 20);
  laz.chunks = {0xFFFFFFF0};
  if (laz.las.format == 6) laz.variable = true;
  std::string bytes = laz.build();
  const std::uint32_t points = 0xFFFFFF00;
  if (laz.las.format == 6) {
    LasBytes::put<std::uint64_t>(bytes, 247, points);
  } else {
    LasBytes::put(bytes, 107, points);
  }
  const auto start = std::chrono::steady_clock::now();
  CHECK_THAT(refusal_of_bytes(bytes), Contains("expected"));
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(5));
}
