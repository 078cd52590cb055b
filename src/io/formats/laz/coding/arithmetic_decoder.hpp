#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "io/formats/byte_load.hpp"
#include "io/formats/laz/coding/entropy_models.hpp"

namespace clearway::laz {

/// The arithmetic decoder of LAZ, after A. Said, "Introduction to Arithmetic Coding - Theory and
/// Practice", HP Laboratories HPL-2004-76. Its inner loop checks no bounds: the caller provides as
/// many bytes as one point can take, which is kMostBytes... for each call, and kReadAhead more.
///
/// It is a value to be copied, because a loop that works on its own copy keeps it in registers.
class ArithmeticDecoder {
 public:
  static constexpr std::size_t kStartBytes = 4;
  static constexpr std::size_t kReadAhead = 4;  ///< bytes read beyond the cursor, but not used
  // Most bytes that one call consumes.
  static constexpr std::size_t kMostBytesSymbol = 2;
  static constexpr std::size_t kMostBytesBits = 5;

  ArithmeticDecoder() = default;
  explicit ArithmeticDecoder(const std::byte* bytes)
      : cursor_(bytes + kStartBytes), value_(big_endian(bytes)) {
    // No encoder gives this value. It is refused because everything below relies on value < length.
    if (value_ == length_) {
      --value_;
      damage_ = 1;
    }
  }

  const std::byte* cursor() const { return cursor_; }
  void move_to(const std::byte* cursor) { cursor_ = cursor; }
  /// Whether the decoded data cannot come from an encoder.
  bool damaged() const { return damage_ != 0; }
  void note_damage() { damage_ = 1; }

  /// Decodes a symbol. value < length always holds, and length >= 2^24, so place < 2^15 + 64.
  template <unsigned kMost>
  [[gnu::always_inline]] inline unsigned symbol(SymbolModel<kMost>& model) {
    const std::uint32_t unit = length_ >> kSymbolShift;
    const std::uint32_t place = value_ / unit;
    unsigned symbol = model.guess(place);
    while (model.first(symbol + 1) <= place) ++symbol;
    const std::uint32_t low = model.first(symbol) * unit;
    const std::uint32_t high = model.is_last(symbol) ? length_ : model.first(symbol + 1) * unit;
    value_ -= low;
    length_ = high - low;
    normalise();
    model.add(symbol);
    return symbol;
  }

  [[gnu::always_inline]] inline unsigned bit(BitModel& model) {
    const std::uint32_t zeros = model.zero_share() * (length_ >> kBitShift);
    const unsigned bit = value_ >= zeros ? 1 : 0;
    value_ -= bit ? zeros : 0;
    length_ = bit ? length_ - zeros : zeros;
    normalise();
    model.add(bit);
    return bit;
  }

  /// Decodes bits without a model; count <= 32.
  [[gnu::always_inline]] inline std::uint32_t bits(unsigned count) {
    if (count <= kMostBitsAtOnce) return some_bits(count);
    const std::uint32_t low = some_bits(16);
    return some_bits(count - 16) << 16 | low;
  }

 private:
  static constexpr unsigned kMostBitsAtOnce = 19;
  static constexpr std::uint32_t kLeastLength = 1u << 24;

  [[gnu::always_inline]] static std::uint32_t big_endian(const std::byte* bytes) {
    return __builtin_bswap32(load<std::uint32_t>(bytes));
  }

  [[gnu::always_inline]] inline std::uint32_t some_bits(unsigned count) {
    length_ >>= count;
    const std::uint32_t bits = value_ / length_;
    value_ -= bits * length_;
    normalise();
    damage_ |= bits >> count;
    return bits;
  }

  /// Shifts whole bytes in until the highest byte of the length is not zero.
  [[gnu::always_inline]] inline void normalise() {
    const unsigned shift = static_cast<unsigned>(__builtin_clz(length_)) & 24u;
    const std::uint64_t wide = std::uint64_t{value_} << 32 | big_endian(cursor_);
    value_ = static_cast<std::uint32_t>(wide << shift >> 32);
    length_ <<= shift;
    cursor_ += shift >> 3;
  }

  const std::byte* cursor_ = nullptr;
  std::uint32_t value_ = 0;
  std::uint32_t length_ = 0xFFFFFFFF;
  std::uint32_t damage_ = 0;
};

}  // namespace clearway::laz
