// Every encoding of a number, in packets that are cut anywhere.
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "io/scans/e57/e57_file.hpp"
#include "support/bytes/e57_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/reader_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

using Integers = std::vector<std::int64_t>;
constexpr auto kLeast = std::numeric_limits<std::int64_t>::min();

/// Random values from `minimum` on that use all `width` bits.
Integers values_of(unsigned width, std::int64_t minimum, std::size_t count) {
  std::mt19937_64 random(width);
  const std::uint64_t mask = width == 0 ? 0 : ~std::uint64_t{0} >> (64 - width);
  Integers values;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t stored = i == 0 ? 0 : i == 1 ? mask : random() & mask;
    values.push_back(static_cast<std::int64_t>(static_cast<std::uint64_t>(minimum) + stored));
  }
  return values;
}

std::int64_t maximum_of(unsigned width, std::int64_t minimum) {
  return values_of(width, minimum, 2)[1];
}

/// Packets that hold a random number of bytes, 0 to 12, of each bytestream.
std::vector<std::vector<std::size_t>> odd_packets(std::size_t fields, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::vector<std::size_t>> packets(60);
  for (auto& packet : packets) {
    for (std::size_t i = 0; i < fields; ++i) packet.push_back(random() % 13);
  }
  return packets;
}

ReadCloud read(const ScratchFolder& scratch, const E57Bytes& file) {
  return read_all(scratch.write("a.e57", file.build()));
}

}  // namespace

TEST_CASE(
    "an E57 integer of any width from 0 to 64 bits is read, whatever its minimum and packets") {
  const ScratchFolder scratch;
  constexpr std::size_t kAll = std::string::npos;
  const std::vector<std::vector<std::size_t>> packets[] = {
      {},
      {{kAll, 0, 0}, {0, kAll, 0}},  // one field runs ahead of the others
      {{0, 0, kAll}, {0, kAll, 0}},
      std::vector<std::vector<std::size_t>>(900, {1, 0, 0})};
  for (unsigned width = 0; width <= 64; ++width) {
    const std::size_t count = width % 10 == 3 ? 3000 : 70;
    Integers minima{kLeast};
    if (width < 64) minima.insert(minima.end(), {0, -5, -(std::int64_t{1} << (width / 2))});
    for (const std::int64_t minimum : minima) {
      INFO("width " << width << ", minimum " << minimum);
      const Integers x = values_of(width, minimum, count);
      const Integers y = values_of(21, -1000, count);
      std::vector<double> z(count);
      for (std::size_t i = 0; i < count; ++i) z[i] = 0.1 * static_cast<double>(i);
      E57Bytes file;
      file.page = std::array{128U, 1024U, 65536U}[width % 3];
      E57Bytes::Scan& scan = file.scans.emplace_back();
      scan.fields = {E57Bytes::integer("cartesianX", minimum, maximum_of(width, minimum), x,
                                       "scale=\"0.001\" offset=\"-3.5\""),
                     E57Bytes::integer("cartesianY", -1000, maximum_of(21, -1000), y),
                     E57Bytes::float64("cartesianZ", z)};
      scan.packets = width % 5 == 4 ? odd_packets(3, width) : packets[width % 5];
      scan.index_packets = width % 2 == 1;
      REQUIRE(scan.fields[0].bits == width);
      const ReadCloud cloud = read(scratch, file);
      REQUIRE(cloud.positions.size() == count);
      for (std::size_t i = 0; i < count; ++i) {
        REQUIRE(cloud.positions[i].x == static_cast<double>(x[i]) * 0.001 + -3.5);
        REQUIRE(cloud.positions[i].y == static_cast<double>(y[i]));
        REQUIRE(cloud.positions[i].z == z[i]);
      }
    }
  }
}

TEST_CASE("fields of any kind that tell no place are stepped over, and an integer has 64 bits") {
  const ScratchFolder scratch;
  E57Bytes file;
  file.scans.push_back(e57_scan({}, {3, 4}, {5, 6}));
  auto& fields = file.scans[0].fields;
  fields[0] = {"<cartesianX type=\"Integer\"/>", 64, {1, std::uint64_t{1} << 63}};
  fields.insert(fields.begin() + 1,
                {"<a:s type=\"Structure\"><cartesianX type=\"Integer\" minimum=\"0\" "
                 "maximum=\"255\"/></a:s><a:e type=\"Structure\"/>",
                 8,
                 {1, 2}});
  // A field of two texts; the byte before each is twice its length.
  fields.push_back({"<a:t type=\"String\"/>", 24, {0x626104, 0x646304}});
  check_equal(read(scratch, file).positions, {{static_cast<double>(kLeast + 1), 3, 5}, {0, 4, 6}});
}

TEST_CASE("zeros up to the next word of 64 bits behind the last record are padding") {
  E57Bytes file;
  file.scans.push_back(e57_scan({0, 0, 0}, {0, 0, 0}, {0, 0, 0}));
  file.scans[0].fields[0] = E57Bytes::integer("cartesianX", 0, 3, {1, 2, 3});
  for (const auto& [padding, is_read] : {std::pair(std::string(7, '\0'), true),
                                         {std::string("\0\0\0\0\0\0\x40", 7), false},
                                         {std::string(8, '\0'), false}}) {
    file.scans[0].padding = padding;
    CHECK(refusal_of_file("a.e57", file.build()).empty() == is_read);
  }
}

TEST_CASE("CRC-32C is that of RFC 3720, by table and by instruction at every length and place") {
  std::string ascending, text;
  for (char c = 0; c < 32; ++c) ascending += c;
  const std::pair<std::string, std::uint32_t> known[] = {{"123456789", 0xE3069283},
                                                         {std::string(32, '\0'), 0x8A9136AA},
                                                         {std::string(32, '\xFF'), 0x62A8AB43},
                                                         {ascending, 0x46DD794E},
                                                         {"", 0}};
  for (const auto& [bytes, sum] : known) {
    CHECK(crc32c(std::as_bytes(std::span(bytes))) == sum);
    CHECK(crc32c_by_table(std::as_bytes(std::span(bytes))) == sum);
    CHECK(E57Bytes::checksum(bytes.data(), bytes.size()) == sum);
  }
  for (std::uint32_t i = 0; i < 80; ++i) text += static_cast<char>(i * 0x9E3779B1U >> 24);
  for (std::size_t start = 0; start < 8; ++start) {
    for (std::size_t count = 0; start + count <= text.size(); ++count) {
      const auto bytes = std::as_bytes(std::span(text)).subspan(start, count);
      const std::uint32_t sum = E57Bytes::checksum(text.data() + start, count);
      REQUIRE(crc32c(bytes) == sum);
      REQUIRE(crc32c_by_table(bytes) == sum);
    }
  }
}
