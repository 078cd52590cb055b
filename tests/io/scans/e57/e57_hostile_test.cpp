// Damaged and hostile binary sections: refused with file and byte, or the same points.
#include <functional>

#include "support/bytes/e57_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Two small scans: one with a pose, in several packets, and a spherical one.
E57Bytes sample() {
  E57Bytes file;
  file.page = 128;
  file.scans = {e57_scan({1, 2, 3}, {4, 5, 6}, {7, 8, 9})};
  file.scans[0].xml = E57Bytes::pose({"0", "1", "0", "0"}, {"1", "2", "3"});
  file.scans[0].packets = {{9, 3, 0}};
  file.scans[0].index_packets = true;
  file.scans.emplace_back();
  file.scans[1].fields = {E57Bytes::float32("sphericalRange", {1, 2}),
                          E57Bytes::float64("sphericalAzimuth", {0.5, 1}),
                          E57Bytes::integer("sphericalElevation", -9, 9, {-9, 4}, "scale=\"0.1\""),
                          E57Bytes::integer("sphericalInvalidState", 0, 2, {0, 2})};
  return file;
}

std::string refusal(const std::string& bytes) {
  static const ScratchFolder scratch;
  const auto path = scratch.write("a.e57", bytes);
  const std::string message = refusal_of(path);
  if (!message.empty()) check_says(message, path.string());
  return message;
}

/// The message with which the file is refused after `change`, with right checksums.
std::string refusal_after(const E57Bytes& file,
                          const std::function<void(E57Bytes::Content&)>& change) {
  E57Bytes::Content content = file.content();
  change(content);
  return refusal(E57Bytes::paged(content.bytes, file.page));
}

void replace(std::string& text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  REQUIRE(at != std::string::npos);
  text.replace(at, what.size(), with);
}

template <typename Number>
auto putting(std::size_t section_byte, Number value) {
  return [=](E57Bytes::Content& content) {
    E57Bytes::put(content.bytes, content.sections[0] + section_byte, value);
  };
}

E57Bytes one_scan() {
  E57Bytes file;
  file.scans = {e57_scan({1, 2}, {3, 4}, {5, 6})};
  return file;
}

}  // namespace

TEST_CASE("a flipped bit of an E57 file is refused: by the checksum of its page or by name") {
  const std::string good = sample().build();
  REQUIRE(refusal(good).empty());
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string bytes = good;
    bytes[i] = static_cast<char>(bytes[i] ^ (1 << (i % 8)));
    INFO("byte " << i);
    check_says(refusal(bytes), "expected");
  }
}

TEST_CASE("a changed byte with a right checksum is refused with a reason, or gives points") {
  const std::string good = sample().build();
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (const int change : {0x01, 0x80, 0xFF}) {
      std::string bytes = good;
      bytes[i] = static_cast<char>(bytes[i] ^ change);
      E57Bytes::repair(bytes, 128);
      INFO("byte " << i << " ^ " << change);
      const std::string message = refusal(bytes);
      if (!message.empty()) check_says(message, "expected");
    }
  }
}

TEST_CASE("an E57 file that is cut or goes on is refused") {
  const std::string good = sample().build();
  for (std::size_t size = 0; size < good.size(); ++size) {
    INFO("cut to " << size);
    check_says(refusal(good.substr(0, size)), "expected");
  }
  check_says(refusal(good + "x"), "expected ... as its header says");
  // The header declares the cut file's size, and cuts are at whole pages.
  for (std::size_t size = 128; size < good.size(); size += 128) {
    std::string bytes = good.substr(0, size);
    E57Bytes::put<std::uint64_t>(bytes, 16, size);
    E57Bytes::repair(bytes, 128);
    check_says(refusal(bytes), "expected");
  }
}

TEST_CASE("the header's fields are checked") {
  const std::string good = one_scan().build();
  const auto with = [&](std::size_t at, std::uint64_t value) {
    std::string bytes = good;
    E57Bytes::put(bytes, at, value);
    E57Bytes::repair(bytes);
    return refusal(bytes);
  };
  check_says(with(8, 2), "byte 8 ... E57 version 2.0");
  check_says(with(8, (std::uint64_t{1} << 32) + 1), "E57 version 1.1");
  check_says(with(16, good.size() + 1), "as its header says");
  for (const std::uint64_t offset : {std::uint64_t{0}, std::uint64_t{47}, std::uint64_t{1020},
                                     std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
    check_says(with(24, offset), "byte 24 ... expected a place");
  }
  check_says(with(32, 5000), "byte 32 ... before the file");
  check_says(with(32, ~std::uint64_t{0}), "byte 32 ... at most 67108864");
  for (const std::uint64_t page : {0, 1, 64, 1000, 131072}) {
    check_says(with(40, page), "byte 40 ... expected 1024");
  }
}

TEST_CASE("a scan's count that lies is refused, in either direction") {
  const auto with_count = [](E57Bytes file, const std::string& count) {
    return refusal_after(file, [&](E57Bytes::Content& content) {
      replace(content.bytes, "recordCount=\"2\"", "recordCount=\"" + count + "\"");
      E57Bytes::put<std::uint64_t>(content.bytes, 32, content.bytes.size() - content.xml);
    });
  };
  for (const char* count : {"3", "1", "1000000", "18446744073709551615"}) {
    INFO(count);
    check_says(with_count(one_scan(), count), "byte 48 ... scan 1");
  }
  check_says(with_count(one_scan(), "18446744073709551616"), "recordCount");
  check_says(with_count(one_scan(), "-1"), "recordCount");
  // One more record is declared, and the last byte has room for its bits.
  E57Bytes narrow;
  narrow.scans.emplace_back();
  narrow.scans[0].fields = {E57Bytes::integer("cartesianX", 0, 3, {1, 2}),
                            E57Bytes::integer("cartesianY", 0, 3, {1, 2}),
                            E57Bytes::integer("cartesianZ", 0, 3, {1, 2})};
  check_says(with_count(narrow, "1"), "behind its last record");
  // Records without any bytes, of which there could be any number.
  E57Bytes nothing;
  nothing.scans.emplace_back();
  for (const std::string axis : {"X", "Y", "Z"}) {
    nothing.scans[0].fields.push_back(E57Bytes::integer("cartesian" + axis, 4, 4, {4, 4}));
  }
  CHECK(with_count(nothing, "65536").empty());
  check_says(with_count(nothing, "65537"), "take no byte");
  nothing.scans.push_back(nothing.scans[0]);
  CHECK(with_count(nothing, "65534").empty());
  check_says(with_count(nothing, "65535"), "scan 2 has 2 records that take no byte");
}

TEST_CASE("a bytestream that has less or more than the records need is refused") {
  E57Bytes file = one_scan();
  SECTION("less, of a field that is read") { file.scans[0].fields[1].stored.pop_back(); }
  SECTION("more, of a field that is read") { file.scans[0].fields[1].stored.push_back(0); }
  SECTION("less, of another") {
    file.scans[0].fields.push_back(E57Bytes::float32("intensity", {1}));
  }
  SECTION("more, of another") {
    file.scans[0].fields.push_back(E57Bytes::float32("intensity", {1, 2, 3}));
  }
  check_says(refusal(file.build()), "byte 48: ... scan 1");
}

TEST_CASE("a binary section that is none, or lies elsewhere, is refused") {
  check_says(refusal_after(one_scan(), putting<std::uint8_t>(0, 2)), "of kind 2");
  for (const std::uint64_t length : {0, 31, 33, 1 << 20}) {
    check_says(refusal_after(one_scan(), putting(8, length)), "a multiple of 4");
  }
  check_says(refusal_after(one_scan(), putting<std::uint64_t>(8, 32)), "expected more");
  for (const std::uint64_t packets : {0, 48, 79, 1020, 1 << 20}) {
    check_says(refusal_after(one_scan(), putting(16, packets)), "within its section");
  }
  for (const std::string offset : {"00", "47", "1020", "1048576", "18446744073709551615"}) {
    check_says(refusal_after(one_scan(),
                             [&](E57Bytes::Content& content) {
                               replace(content.bytes, "fileOffset=\"48\"",
                                       "fileOffset=\"" + offset + "\"");
                               E57Bytes::put<std::uint64_t>(content.bytes, 32,
                                                            content.bytes.size() - content.xml);
                             }),
               "scan 1 has its points at byte");
  }
}

TEST_CASE("packets are walked in order, no offset of an index is followed") {
  E57Bytes file = one_scan();
  file.scans[0].index_packets = true;
  // The index packet's entries, and its offset in the section's header, point at the index itself.
  CHECK(refusal_after(file, putting<std::uint64_t>(24, 80)).empty());
  CHECK(refusal_after(file, putting<std::uint64_t>(32 + 8, 80)).empty());
  check_says(refusal_after(file, putting<std::uint8_t>(32, 3)), "has kind 3");
  // There are 16 bytes of index, 4 ignored bytes, and then the data packet.
  for (const int length : {0, 1, 4, 60, 67, 0xFFFF}) {
    check_says(refusal_after(file, putting(32 + 20 + 2, static_cast<std::uint16_t>(length))),
               "packet of scan 1 ... expected");
  }
  check_says(refusal_after(file, putting<std::uint16_t>(32 + 20 + 4, 2)), "2 bytestreams");
  check_says(refusal_after(file, putting<std::uint16_t>(32 + 20 + 4, 0)), "scan 1 ends");
  check_says(refusal_after(file, putting<std::uint16_t>(32 + 20 + 6, 15)),
             "scan 1 ends after 1 records; expected 2");
  check_says(refusal_after(file, putting<std::uint16_t>(32 + 20 + 6, 0xFFFF)),
             "lengths of its bytestreams");
}

TEST_CASE("a packet that restarts within a record is refused, at a record's end it is read") {
  E57Bytes file = one_scan();
  const bool within = GENERATE(false, true);
  file.scans[0].packets = {{within ? 9U : 8U, 8, 8}};
  // The second packet has 6 bytes, 3 lengths and the streams, filled up to words.
  const std::size_t first = within ? 40 : 36;
  const std::string message = refusal_after(file, putting<std::uint8_t>(32 + first + 1, 1));
  CHECK(message.empty() != within);
  if (within) check_says(message, "within a record");
}

TEST_CASE("scans that share their bytes are refused") {
  E57Bytes file = one_scan();
  file.scans.push_back(file.scans[0]);
  const std::string second = std::to_string(file.physical(file.content().sections[1]));
  check_says(refusal_after(file,
                           [&](E57Bytes::Content& content) {
                             replace(content.bytes, "fileOffset=\"" + second + "\"",
                                     "fileOffset=\"48\"" + std::string(second.size() - 2, ' '));
                           }),
             "scan 2 shares bytes with scan 1");
}

TEST_CASE("an invalid state beyond 2 is refused with its record") {
  E57Bytes file = one_scan();
  file.scans[0].fields.push_back(E57Bytes::integer("cartesianInvalidState", 0, 3, {0, 3}));
  check_says(refusal(file.build()), "scan 1, record 1 ... state 3");
}
