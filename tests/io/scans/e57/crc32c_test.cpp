#include <catch2/catch.hpp>
#include <string>

#include "io/scans/e57/e57_file.hpp"
#include "support/bytes/e57_bytes.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("CRC-32C gives the values of RFC 3720, by table and by instruction") {
  std::string ascending, descending;
  for (char c = 0; c < 32; ++c) {
    ascending += c;
    descending = c + descending;
  }
  const std::pair<std::string, std::uint32_t> known[] = {{"123456789", 0xE3069283},
                                                         {std::string(32, '\0'), 0x8A9136AA},
                                                         {std::string(32, '\xFF'), 0x62A8AB43},
                                                         {ascending, 0x46DD794E},
                                                         {descending, 0x113FDB5C},
                                                         {"", 0}};
  for (const auto& [text, sum] : known) {
    CHECK(crc32c(std::as_bytes(std::span(text))) == sum);
    CHECK(crc32c_by_table(std::as_bytes(std::span(text))) == sum);
    CHECK(E57Bytes::checksum(text.data(), text.size()) == sum);
  }
}

TEST_CASE(
    "CRC-32C is the same byte by byte, by table and by instruction at every length and place") {
  std::string text;
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
