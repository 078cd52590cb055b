#include <chrono>
#include <limits>

#include "support/bytes/laz/laz_samples.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::string refusal_of_bytes(const std::string& bytes) {
  ScratchFolder scratch;
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
    check_says(message, "a.laz ... expected");
    return message;
  };
  check_says(refusal(0, 0), "compressor 0");
  check_says(refusal(0, 4), "compressor 4");
  check_says(refusal(0, 3), "POINT10");
  check_says(refusal(2, 1), "coder 1");
  check_says(refusal(32, 2), "2 items");
  check_says(refusal(34, 1), "type 1");
  check_says(refusal(34, 10), "POINT14 of 30 bytes");
  check_says(refusal(36, 21), "POINT10 of 20 bytes");
  check_says(refusal(38, 3), "version 3 ... 1 to 2");
  check_says(refusal(40, 8), "RGB12 of 6 bytes");
  check_says(refusal(48, 4), "items of 32 bytes");
  check_says(refusal(46, 7), "GPSTIME11");
}

TEST_CASE("a LAZ header and its record have to agree") {
  LazBytes laz = laz_bytes(1, 20);
  check_says(refusal_with<std::uint8_t>(laz, 104, 1), "ends at byte");
  laz.las.vlrs = {{"laszip encoded", 22204, "payload"}};
  check_says(refusal_of_bytes(laz.las.build()), "byte 104 ... not compressed");
  laz.las.vlrs.clear();
  check_says(refusal_with<std::uint8_t>(laz, 104, 0xC1), "before LASzip 1.0");
  CHECK(refusal_with<std::uint8_t>(laz, 104, 0x41).empty());
  check_says(refusal_with<std::uint8_t>(laz, 104, 0x8B), "point format 11");
  check_says(refusal_with<char>(laz, laz.las.points_offset() + 2, 'x'),
             "byte 104 ... laszip encoded");
  LazBytes six = laz_bytes(6, 20);
  check_says(refusal_with<std::uint8_t>(six, 104, 0x81), "point format 1");
}

TEST_CASE("a chunk table that disagrees with the header is refused with both numbers") {
  LazBytes laz = laz_bytes(6, 15);
  laz.variable = GENERATE(false, true);
  const auto declared = [&](std::uint64_t points) {
    return refusal_with<std::uint64_t>(laz, 247, points);
  };
  CHECK_THAT(declared(16), Contains("15") || Contains("16"));
  check_says(declared(10), "expected 10 ... write the file again");
  check_says(declared(0), "expected 0 ... write the file again");
  CHECK_THAT(declared(11), Contains("11") || Contains("5 points by its own count, but 1 by the"));
  check_says(declared(std::uint64_t{1} << 60), "1152921504606846976");
}

TEST_CASE("a chunk table in the wrong place, or of what cannot be, is refused") {
  const LazBytes laz = laz_bytes(0, 20);
  const std::size_t pointer = laz.points_offset();
  const std::uint64_t table = table_of(laz), size = laz.build().size();
  const auto moved = [&](std::uint64_t place) {
    std::string message = refusal_with(laz, pointer, place);
    check_says(message, "a.laz ... expected");
    return message;
  };
  check_says(moved(pointer + 7), "chunk table");
  check_says(moved(size), "cut");
  check_says(moved(size - 7), "cut");
  check_says(moved(std::numeric_limits<std::uint64_t>::max() - 1), "cut");
  moved(table - 1);
  moved(table + 1);
  check_says(refusal_with<std::uint32_t>(laz, table, 1), "version 1");
  check_says(refusal_with<std::uint32_t>(laz, table + 4, 0xFFFFFFFF), "4294967295");
  check_says(refusal_with<std::uint32_t>(laz, table + 4, 3), "15 points");
  check_says(refusal_with<std::uint32_t>(laz, table + 4, 5), "chunk 5 of 5");
}

TEST_CASE("a count below the points of a file without a table is refused") {
  LazBytes laz = laz_bytes(0, 20);
  laz.table = LazBytes::Table::kNone;
  check_says(refusal_with<std::uint32_t>(laz, 107, 10),
             "bytes behind the 10 points ... write the file again");
  check_says(refusal_with<std::uint32_t>(laz, 107, 0), "behind the 0 points");
  check_says(refusal_with<std::uint32_t>(laz, 107, 25), "chunk 5");
  laz.variable = true;
  check_says(refusal_of_bytes(laz.build()), "no chunk table");
}

TEST_CASE("a damaged chunk is named: the first of several") {
  LazBytes laz = laz_bytes(7, 40);
  std::string bytes = laz.build();
  const std::size_t first = laz.points_offset() + 8;
  // The count of a layered chunk stands behind its first record.
  const std::size_t count = first + laz.las.record_bytes();
  bytes[count] = 4;
  check_says(refusal_of_bytes(bytes), "a.laz: chunk 1 of 8:  ... holds 4 points");
  bytes[count] = 5;
  bytes[count + 4] = static_cast<char>(bytes[count + 4] + 1);
  check_says(refusal_of_bytes(bytes), "chunk 1 of 8: its layers have 1 bytes more");
  bytes[count + 4] = static_cast<char>(bytes[count + 4] - 2);
  check_says(refusal_of_bytes(bytes), "chunk 1 of 8: has 1 bytes behind");
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
  check_says(refusal_of_bytes(bytes), "expected");
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(5));
}
