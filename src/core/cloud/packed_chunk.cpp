#include "core/cloud/packed_chunk.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <string>

namespace clearway {
namespace {

constexpr std::size_t kMinimumAt = 5;  // uint32 minbits, one byte 8, then uint64 minimum

template <std::integral Value>
struct Header {
  std::uint32_t minbits;
  Value minimum;
};

template <std::integral Value>
Header<Value> header_for(Value minimum, Value maximum) {
  using Unsigned = std::make_unsigned_t<Value>;
  const auto range =
      static_cast<Unsigned>(static_cast<Unsigned>(maximum) - static_cast<Unsigned>(minimum));
  // HDF5 gives up on such a range before it notes the minimum.
  if (range > std::numeric_limits<Unsigned>::max() - 2) return {kValueBits<Value>, 0};
  return {static_cast<std::uint32_t>(std::bit_width(range)), minimum};  // ceil(log2(range + 1))
}

}  // namespace

template <std::integral Value>
PackedChunk<Value>::PackedChunk(std::span<const std::byte> bytes, std::uint32_t count)
    : count_(count) {
  if (bytes.size() < kPackedHeaderBytes) {
    throw InputError("a packed chunk of " + std::to_string(bytes.size()) +
                     " bytes, expected at least " + std::to_string(kPackedHeaderBytes));
  }
  std::uint32_t minbits = 0;
  std::memcpy(&minbits, bytes.data(), 4);
  if (minbits > kValueBits<Value>) {
    throw InputError("a packed chunk with " + std::to_string(minbits) +
                     " bits a value, expected at most " + std::to_string(kValueBits<Value>));
  }
  const auto is_zero = [](std::byte b) { return b == std::byte{0}; };
  if (bytes[4] != std::byte{8} ||
      !std::all_of(bytes.begin() + kMinimumAt + 8, bytes.begin() + kPackedHeaderBytes, is_zero)) {
    throw InputError("a packed chunk whose header is not that of HDF5's scale-offset filter");
  }
  const std::uint64_t expected = packed_bytes<Value>(count, minbits);
  if (bytes.size() != expected) {
    throw InputError("a packed chunk of " + std::to_string(bytes.size()) + " bytes, expected " +
                     std::to_string(expected) + " for " + std::to_string(count) + " values of " +
                     std::to_string(minbits) + " bits");
  }
  std::uint64_t minimum = 0;
  std::memcpy(&minimum, bytes.data() + kMinimumAt, 8);
  minimum_ = static_cast<Unsigned>(minimum);
  minbits_ = minbits;
  payload_ = bytes.data() + kPackedHeaderBytes;
  payload_bytes_ = bytes.size() - kPackedHeaderBytes;
}

template <std::integral Value>
void append_packed_chunk(std::span<const Value> values, std::vector<std::byte>& out) {
  const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
  const auto [minbits, minimum] = header_for(*least, *greatest);
  const std::size_t start = out.size();
  out.resize(start + packed_bytes<Value>(values.size(), minbits));
  std::byte* to = out.data() + start;

  std::uint64_t minimum_word = 0;
  if constexpr (std::is_signed_v<Value>) {
    minimum_word = static_cast<std::uint64_t>(std::int64_t{minimum});
  } else {
    minimum_word = minimum;
  }
  std::memcpy(to, &minbits, 4);
  to[4] = std::byte{8};
  std::memcpy(to + kMinimumAt, &minimum_word, 8);
  to += kPackedHeaderBytes;

  if (minbits == kValueBits<Value>) {
    std::memcpy(to, values.data(), values.size_bytes());
    return;
  }
  if (minbits == 0) return;
  using Unsigned = std::make_unsigned_t<Value>;
  __extension__ using Window = unsigned __int128;  // up to 7 pending bits and 63 new ones
  Window pending = 0;
  unsigned pending_bits = 0;
  for (const Value value : values) {
    const auto delta =
        static_cast<Unsigned>(static_cast<Unsigned>(value) - static_cast<Unsigned>(minimum));
    pending = (pending << minbits) | delta;
    pending_bits += minbits;
    while (pending_bits >= 8) {
      pending_bits -= 8;
      *to++ = static_cast<std::byte>(static_cast<unsigned char>(pending >> pending_bits));
    }
  }
  if (pending_bits > 0) {
    *to = static_cast<std::byte>(static_cast<unsigned char>(pending << (8 - pending_bits)));
  }
}

template class PackedChunk<std::int32_t>;
template class PackedChunk<std::uint64_t>;
template void append_packed_chunk(std::span<const std::int32_t>, std::vector<std::byte>&);
template void append_packed_chunk(std::span<const std::uint64_t>, std::vector<std::byte>&);

}  // namespace clearway
