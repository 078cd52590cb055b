#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "clearway/error.hpp"

/// The bytes of one chunk of a store's point datasets, as HDF5's scale-offset filter writes them
/// for integers with an undefined fill value (docs/design/store-format.md, "Packed chunks"): a
/// 21-byte header (minbits, 8, minimum, zeros), then value - minimum in `minbits` bits each, most
/// significant bit first. Value: std::int32_t, std::uint64_t or std::uint8_t.
namespace clearway {

inline constexpr std::size_t kPackedHeaderBytes = 21;

template <std::integral Value>
inline constexpr unsigned kValueBits = 8 * sizeof(Value);

/// Size of a chunk of `count` values in `minbits` bits, bytes.
template <std::integral Value>
constexpr std::uint64_t packed_bytes(std::uint64_t count, unsigned minbits) {
  if (minbits == kValueBits<Value>) return kPackedHeaderBytes + count * sizeof(Value);
  return kPackedHeaderBytes + count * minbits / 8 + 1;
}

/// A validated view of a packed chunk: values can be read at random, never past the chunk's bytes.
/// Does not own the bytes.
template <std::integral Value>
class PackedChunk {
 public:
  using Unsigned = std::make_unsigned_t<Value>;

  PackedChunk() = default;

  /// bytes: a whole chunk of exactly `count` values; throws InputError otherwise, to which the
  /// caller adds file and cell.
  PackedChunk(std::span<const std::byte> bytes, std::uint32_t count);

  /// A chunk that was validated before, made from the parts of its header and the payload after it.
  static PackedChunk of_payload(const std::byte* payload, std::uint32_t count, unsigned minbits,
                                Value minimum);

  std::uint32_t size() const { return count_; }
  unsigned minbits() const { return minbits_; }
  /// Minimum from the header; not that of the values if minbits() is the full width.
  Value minimum() const { return static_cast<Value>(minimum_); }
  /// The bytes after the header.
  const std::byte* payload() const { return payload_; }

  /// Value number `index`, which must be below size().
  Value operator[](std::uint32_t index) const;

  /// Decodes values first .. first + out.size() - 1 into `out`.
  void decode(std::uint32_t first, std::span<Value> out) const;

 private:
  std::uint64_t window(std::uint64_t byte) const;

  const std::byte* payload_ = nullptr;
  std::uint64_t payload_bytes_ = 0;
  Unsigned minimum_ = 0;
  unsigned minbits_ = 0;
  std::uint32_t count_ = 0;
};

/// Appends the packed chunk of `values` (at least one) to `out`. The byte that HDF5 1.10.8 leaves
/// uninitialised at the end of the payload is zero.
template <std::integral Value>
void append_packed_chunk(std::span<const Value> values, std::vector<std::byte>& out);

// ---- implementation

template <std::integral Value>
inline PackedChunk<Value> PackedChunk<Value>::of_payload(const std::byte* payload,
                                                         std::uint32_t count, unsigned minbits,
                                                         Value minimum) {
  PackedChunk chunk;
  chunk.payload_ = payload;
  chunk.payload_bytes_ = packed_bytes<Value>(count, minbits) - kPackedHeaderBytes;
  chunk.minimum_ = static_cast<Unsigned>(minimum);
  chunk.minbits_ = minbits;
  chunk.count_ = count;
  return chunk;
}

/// Eight bytes from `byte` on as a big-endian number; bytes past the payload read as zero.
template <std::integral Value>
inline std::uint64_t PackedChunk<Value>::window(std::uint64_t byte) const {
  std::uint64_t word = 0;
  if (byte + 8 <= payload_bytes_) [[likely]] {
    std::memcpy(&word, payload_ + byte, 8);
    return __builtin_bswap64(word);
  }
  for (unsigned i = 0; i < 8; ++i) {
    word <<= 8;
    if (byte + i < payload_bytes_) word |= std::to_integer<std::uint64_t>(payload_[byte + i]);
  }
  return word;
}

template <std::integral Value>
inline Value PackedChunk<Value>::operator[](std::uint32_t index) const {
  if (minbits_ == 0) return static_cast<Value>(minimum_);
  if (minbits_ == kValueBits<Value>) {
    Value value;
    std::memcpy(&value, payload_ + std::uint64_t{index} * sizeof(Value), sizeof(Value));
    return value;
  }
  const std::uint64_t bit = std::uint64_t{index} * minbits_;
  const auto shift = static_cast<unsigned>(bit % 8);
  std::uint64_t delta = window(bit / 8) << shift;
  if constexpr (sizeof(Value) == 8) {
    if (shift + minbits_ > 64) {  // takes bits of the ninth byte
      delta |= window(bit / 8 + 8) >> (64 - shift);
    }
  }
  delta >>= 64 - minbits_;
  return static_cast<Value>(static_cast<Unsigned>(minimum_ + static_cast<Unsigned>(delta)));
}

template <std::integral Value>
inline void PackedChunk<Value>::decode(std::uint32_t first, std::span<Value> out) const {
  if constexpr (sizeof(Value) == 4) {
    const std::uint64_t end_bit = (std::uint64_t{first} + out.size()) * minbits_;
    if (minbits_ > 0 && minbits_ < kValueBits<Value> && end_bit / 8 + 8 <= payload_bytes_) {
      std::uint64_t bit = std::uint64_t{first} * minbits_;
      for (std::size_t i = 0; i < out.size(); ++i, bit += minbits_) {
        std::uint64_t word;  // all eight bytes are inside the payload
        std::memcpy(&word, payload_ + bit / 8, 8);
        const std::uint64_t delta = __builtin_bswap64(word) << (bit % 8) >> (64 - minbits_);
        out[i] = static_cast<Value>(static_cast<Unsigned>(minimum_ + static_cast<Unsigned>(delta)));
      }
      return;
    }
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = (*this)[first + static_cast<std::uint32_t>(i)];
  }
}

extern template class PackedChunk<std::int32_t>;
extern template class PackedChunk<std::uint64_t>;
extern template class PackedChunk<std::uint8_t>;

}  // namespace clearway
