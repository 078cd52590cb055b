#include <algorithm>
#include <memory>

#include "core/cloud/packed_cloud.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/packed_values.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A chunk's bytes at the very end of a block of the heap, where a sanitizer sees every read past
/// them.
class ExactBytes {
 public:
  explicit ExactBytes(const std::vector<std::byte>& bytes)
      : bytes_(new std::byte[bytes.size()]), size_(bytes.size()) {
    std::copy(bytes.begin(), bytes.end(), bytes_.get());
  }
  std::span<const std::byte> span() const { return {bytes_.get(), size_}; }

 private:
  std::unique_ptr<std::byte[]> bytes_;
  std::size_t size_;
};

/// Packs the payload bit by bit, straight from the format's description.
template <typename Value>
std::vector<std::byte> plainly_packed(const std::vector<Value>& values, unsigned minbits) {
  using Unsigned = std::make_unsigned_t<Value>;
  std::vector<std::byte> payload(values.size() * minbits / 8 + 1);
  const auto least = static_cast<Unsigned>(*std::ranges::min_element(values));
  std::size_t bit = 0;
  for (const Value value : values) {
    const auto delta = static_cast<Unsigned>(static_cast<Unsigned>(value) - least);
    for (unsigned i = minbits; i-- > 0; ++bit) {
      if (delta >> i & 1) payload[bit / 8] |= std::byte{0x80} >> (bit % 8);
    }
  }
  return payload;
}

/// Packs values and reads them one by one, and in whole and partial runs from every offset (of long
/// chunks: from many).
template <typename Value>
void check_round_trip(const std::vector<Value>& values, unsigned minbits) {
  CAPTURE(values.size(), minbits);
  const ExactBytes bytes(packed(values));
  REQUIRE(bytes.span().size() == packed_bytes<Value>(values.size(), minbits));
  const PackedChunk<Value> chunk(bytes.span(), static_cast<std::uint32_t>(values.size()));
  REQUIRE(chunk.size() == values.size());
  REQUIRE(chunk.minbits() == minbits);
  if (minbits < kValueBits<Value>) {
    REQUIRE(chunk.minimum() == *std::ranges::min_element(values));
    REQUIRE(std::ranges::equal(bytes.span().subspan(kPackedHeaderBytes),
                               plainly_packed(values, minbits)));
  }
  std::vector<Value> out(values.size());
  for (std::uint32_t i = 0; i < values.size(); ++i) out[i] = chunk[i];
  REQUIRE(out == values);
  const std::uint32_t step = values.size() > 100 ? 37 : 1;
  for (std::uint32_t first = 0; first <= values.size(); first += step) {
    for (const std::size_t length :
         {std::size_t{0}, std::size_t{1}, std::size_t{64}, values.size()}) {
      out.assign(std::min(length, values.size() - first), Value{});
      chunk.decode(first, out);
      REQUIRE(std::equal(out.begin(), out.end(), values.begin() + first));
    }
  }
}

template <typename Value>
void check_span(std::make_unsigned_t<Value> span, unsigned minbits) {
  for (const std::uint32_t size : {2, 7, 64, 1000, 65536}) {  // the last is a full cell
    if (size == 65536 && minbits % 8 != 1) continue;
    check_round_trip(values_of_span<Value>(size, span, size), minbits);
  }
}

std::string refusal(const std::vector<std::byte>& bytes, std::uint32_t count) {
  try {
    PackedChunk<std::int32_t>(bytes, count);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEMPLATE_TEST_CASE("packed values of every width read back, the widest of them raw", "",
                   std::int32_t, std::uint64_t) {
  using Unsigned = std::make_unsigned_t<TestType>;
  constexpr unsigned kBits = kValueBits<TestType>;
  for (unsigned bits = 0; bits <= kBits; ++bits) {
    check_span<TestType>(span_of_bits<TestType>(bits, bits), bits);
    if (bits < 2 || bits == kBits) continue;
    const auto power = static_cast<Unsigned>(Unsigned{1} << bits);
    check_span<TestType>(power - 1, bits);
    check_span<TestType>(power, bits + 1);
  }
  using Limits = std::numeric_limits<TestType>;
  for (const unsigned below : {0u, 1u, 2u, 3u}) {
    check_span<TestType>(std::numeric_limits<Unsigned>::max() - below, kBits);
  }
  check_round_trip<TestType>({Limits::max(), Limits::min(), 0, 1, Limits::min()}, kBits);
  for (const TestType value : {Limits::min(), TestType{0}, TestType{77}, Limits::max()}) {
    check_round_trip<TestType>({value}, 0);
    check_round_trip(std::vector<TestType>(1000, value), 0);
    REQUIRE(packed(std::vector<TestType>(1000, value)).size() == kPackedHeaderBytes + 1);
  }
}

TEST_CASE("chunks are appended, the header is HDF5's") {
  std::vector<std::byte> bytes{std::byte{42}};
  const std::vector<std::int32_t> values{-2, 1};
  append_packed_chunk<std::int32_t>(values, bytes);
  const unsigned char expected[] = {42,   2,    0, 0, 0, 8, 0xfe, 0xff, 0xff, 0xff, 0xff, 0xff,
                                    0xff, 0xff, 0, 0, 0, 0, 0,    0,    0,    0,    0x30};
  CHECK(std::ranges::equal(bytes, std::as_bytes(std::span(expected))));
}

TEST_CASE("chunks of a wrong size are refused") {
  for (const std::int32_t greatest : {0, 1, 1000, 2147483647}) {
    const std::vector<std::int32_t> values{-1, greatest - 1, -1};
    const auto bytes = packed(values);
    REQUIRE(refusal(bytes, 3).empty());
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      CHECK_FALSE(
          refusal({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)}, 3).empty());
    }
    auto longer = bytes;
    longer.push_back(std::byte{0});
    check_says(refusal(longer, 3), "expected " + std::to_string(bytes.size()));
  }
  const auto bytes = packed(values_of_span<std::int32_t>(64, 1000, 1));
  CHECK_FALSE(refusal(bytes, 62).empty());
  CHECK_FALSE(refusal(bytes, 66).empty());
}

TEST_CASE("chunks with another header are refused") {
  const auto bytes = packed(values_of_span<std::int32_t>(64, 1000, 1));
  for (const std::size_t at : {0u, 1u, 2u, 3u, 4u, 13u, 14u, 20u}) {
    auto damaged = bytes;
    damaged[at] ^= std::byte{0x80};
    CAPTURE(at);
    CHECK_FALSE(refusal(damaged, 64).empty());
  }
  auto wide = packed(std::vector<std::int32_t>{-2147483647, 2147483647});
  wide[0] = std::byte{33};
  check_says(refusal(wide, 2), "at most 32");
}
