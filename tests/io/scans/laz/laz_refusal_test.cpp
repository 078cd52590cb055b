// What a LAZ file must not say. LAZ has no checksums, so a flipped byte may give other points; but
// reading ends, with as many points as declared or with a refusal that names the file.
#include <chrono>

#include "support/bytes/laz/laz_samples.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A number of so many bytes at a place, and the words with which the file is refused for it; none
/// where it is read.
struct Edit {
  std::size_t at;
  unsigned size;
  std::uint64_t value;
  const char* words;
};

std::string refusal(const std::string& bytes) { return refusal_of_file("a.laz", bytes); }

void check_refused_after(const LazBytes& laz, const std::vector<Edit>& edits) {
  for (const Edit& edit : edits) {
    const RowName row(edit.words);
    check_says(refusal(edited(laz.build(), edit.at, edit.size, edit.value)), edit.words);
  }
}

}  // namespace

TEST_CASE("what a LAZ record must not say is refused, with what was expected") {
  const LazBytes laz = laz_bytes(1, 20);
  // The payload of the LAZ record, which is the last before the points
  const std::size_t at = laz.las.points_offset() + 54;
  check_refused_after(laz, {{at, 2, 0, "compressor 0 ... expected"},
                            {at, 2, 4, "compressor 4 ... expected"},
                            {at, 2, 3, "POINT10"},
                            {at + 2, 2, 1, "coder 1"},
                            {at + 32, 2, 2, "2 items"},
                            {at + 34, 2, 1, "type 1"},
                            {at + 34, 2, 10, "POINT14 of 30 bytes"},
                            {at + 36, 2, 21, "POINT10 of 20 bytes"},
                            {at + 38, 2, 3, "version 3 ... 1 to 2"},
                            {at + 40, 2, 8, "RGB12 of 6 bytes"},
                            {at + 48, 2, 4, "items of 32 bytes"},
                            {at + 46, 2, 7, "GPSTIME11"}});
}

TEST_CASE("a LAZ header and its record have to agree") {
  LazBytes laz = laz_bytes(1, 20);
  // Byte 104 is the point format, 1 here, with the bits 0x80 and 0x40 for compressed points
  check_refused_after(laz, {{104, 1, 1, "ends at byte"},
                            {104, 1, 0xC1, "before LASzip 1.0"},
                            {104, 1, 0x41, ""},  // is read
                            {104, 1, 0x8B, "point format 11"},
                            {laz.las.points_offset() + 2, 1, 'x', "byte 104 ... laszip encoded"}});
  check_refused_after(laz_bytes(6, 20), {{104, 1, 0x81, "point format 1"}});
  // A LAS file that is not compressed, with the record of LAZ
  laz.las.vlrs = {{"laszip encoded", 22204, "payload"}};
  check_says(refusal(laz.las.build()), "byte 104 ... not compressed");
}

TEST_CASE("a chunk table that disagrees with the header is refused with both numbers") {
  LazBytes laz = laz_bytes(6, 15);
  for (const bool variable : {false, true}) {
    laz.variable = variable;
    check_refused_after(laz, {{247, 8, 16, variable ? "15" : "16"},
                              {247, 8, 10, "expected 10 ... write the file again"},
                              {247, 8, 0, "expected 0 ... write the file again"},
                              {247, 8, 11, variable ? "11" : "5 points by its own count, but 1 by"},
                              {247, 8, std::uint64_t{1} << 60, "1152921504606846976"}});
  }
}

TEST_CASE("a chunk table in the wrong place, or of what cannot be, is refused") {
  const LazBytes laz = laz_bytes(0, 20);
  const std::string sound = laz.build();
  const std::size_t pointer = laz.points_offset(), size = sound.size();
  std::uint64_t table = 0;
  std::memcpy(&table, sound.data() + pointer, sizeof table);
  check_refused_after(laz, {{pointer, 8, pointer + 7, "chunk table ... expected"},
                            {pointer, 8, size, "cut"},
                            {pointer, 8, size - 7, "cut"},
                            {pointer, 8, ~std::uint64_t{1}, "cut"},
                            {pointer, 8, table - 1, "expected"},
                            {pointer, 8, table + 1, "expected"},
                            {table, 4, 1, "version 1"},
                            {table + 4, 4, 0xFFFFFFFF, "4294967295"},
                            {table + 4, 4, 3, "15 points"},
                            {table + 4, 4, 5, "chunk 5 of 5"}});
}

TEST_CASE("a count below the points of a file without a table is refused") {
  LazBytes laz = laz_bytes(0, 20);
  laz.table = LazBytes::Table::kNone;
  check_refused_after(laz, {{107, 4, 10, "bytes behind the 10 points ... write the file again"},
                            {107, 4, 0, "behind the 0 points"},
                            {107, 4, 25, "chunk 5"}});
  laz.variable = true;
  check_says(refusal(laz.build()), "no chunk table");
}

TEST_CASE("a damaged chunk is named: the first of several") {
  const LazBytes laz = laz_bytes(7, 40);
  // The count of a layered chunk stands behind its first record, and then the size of a layer.
  const std::size_t count = laz.points_offset() + 8 + laz.las.record_bytes();
  const std::string sound = laz.build();
  const int layer = static_cast<unsigned char>(sound[count + 4]);
  check_refused_after(laz, {{count, 1, 4, "a.laz: chunk 1 of 8:  ... holds 4 points"},
                            {count + 4, 1, static_cast<std::uint8_t>(layer + 1),
                             "chunk 1 of 8: its layers have 1 bytes more"},
                            {count + 4, 1, static_cast<std::uint8_t>(layer - 1),
                             "chunk 1 of 8: has 1 bytes behind"}});
}

TEST_CASE("a chunk of few bytes does not take the time of the points it claims") {
  for (const unsigned format : {0u, 6u}) {
    LazBytes laz = laz_bytes(format, 20);
    laz.chunks = {0xFFFFFFF0};
    laz.variable = format == 6;
    const auto start = std::chrono::steady_clock::now();
    check_refused_after(laz, {{format == 6 ? 247u : 107u, 4, 0xFFFFFF00, "expected"}});
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(5));
  }
}

TEST_CASE("every byte of a LAZ file flipped: refused, or as many points as declared") {
  const unsigned format = GENERATE(from_range(std::begin(kLazFormats), std::end(kLazFormats)));
  CAPTURE(format);
  LazBytes laz = laz_bytes(format, 40);
  laz.chunks = {25};
  if (format == 1 || format == 7) laz.table = LazBytes::Table::kAtEnd;
  if (format == 2 || format == 8) laz.table = LazBytes::Table::kNone;
  if (format == 3 || format == 6) {
    laz.variable = true;
    laz.chunks = {10, 1, 29};
  }
  const std::string sound = laz.build();
  const auto expected = positions_of(laz.points);
  const ScratchFolder scratch;
  int refused = 0, same = 0;
  for (std::size_t at = 0; at < sound.size(); ++at) {
    std::string bytes = sound;
    bytes[at] = static_cast<char>(bytes[at] ^ (at % 3 == 0 ? 0xFF : 1 << at % 8));
    const auto path = scratch.write("a.laz", bytes);
    try {
      const ReadCloud cloud = read_all(path);
      if (cloud.size() != cloud.info.declared_points) FAIL("another count after byte " << at);
      same += cloud.quanta == expected;
    } catch (const InputError& error) {
      if (std::string(error.what()).find(path.string()) == std::string::npos) FAIL(error.what());
      ++refused;
    }
  }
  CHECK(refused > 0);
  CHECK(same > 0);
}

TEST_CASE("a LAZ file cut at any byte is refused, or has all its points") {
  const unsigned format = GENERATE(from_range(std::begin(kLazFormats), std::end(kLazFormats)));
  std::vector<LazBytes> files(2, laz_bytes(format, 30));
  files[1].table = LazBytes::Table::kAtEnd;
  if (format >= 6) files.emplace_back(files[0]).las.evlrs = {{"someone", 1, "payload"}};
  const ScratchFolder scratch;
  for (const LazBytes& laz : files) {
    const std::string bytes = laz.build();
    // Some bytes may be missing at the end only where no place of a table stands before the points.
    const bool at_end = laz.table == LazBytes::Table::kAtEnd;
    const std::size_t spare = at_end ? bytes.size() - files[0].build().size() + 30 : 0;
    for (std::size_t size = bytes.size() + 1; size-- > 0;) {
      const auto path = scratch.write("a.laz", std::string_view(bytes).substr(0, size));
      const std::string message = refusal_of(path);
      if (message.empty()) {
        CHECK(size + spare >= bytes.size());
        CHECK(read_all(path).quanta == positions_of(laz.points));
      } else if (message.find(path.string()) == std::string::npos || size == bytes.size()) {
        FAIL(message);
      }
    }
  }
}
