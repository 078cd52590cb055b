#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <vector>

#include "io/files/bytes.hpp"

/// The adaptive models of LAZ. How and when their counts become probabilities is part of the format
/// (docs/design/inputs.md); how a symbol is found is not.
namespace clearway::laz {

constexpr unsigned kSymbolShift = 15;  ///< probabilities of symbols are fractions of 2^15
constexpr unsigned kBitShift = 13;     ///< probabilities of bits are fractions of 2^13

/// Counts that models of any alphabet have in common.
struct SymbolCounts {
  std::uint32_t until_update;
  std::uint32_t cycle;  ///< number of symbols between two updates
  std::uint32_t total = 0;
};

/// Counts of up to kMost symbols, and their cumulative distribution as it was at the last update.
template <unsigned kMost>
class SymbolModel {
 public:
  explicit SymbolModel(unsigned symbols = kMost)
      : symbols_(symbols),
        slot_shift_(kSymbolShift - slot_bits(symbols)),
        counts_{.until_update = 0, .cycle = symbols} {
    count_.fill(1);
    update();
    counts_.until_update = counts_.cycle = (symbols + 6) >> 1;
  }

  /// A symbol not greater than the one at `place`, and rarely much less.
  unsigned guess(std::uint32_t place) const { return guess_[place >> slot_shift_]; }
  /// Start of the symbol's range; for the symbol after the last, a number beyond every place.
  std::uint32_t first(unsigned symbol) const { return first_[symbol]; }
  bool is_last(unsigned symbol) const { return symbol + 1 == symbols_; }

  void add(unsigned symbol) {
    ++count_[symbol];
    if (--counts_.until_update == 0) update();
  }

 private:
  using Symbol = std::conditional_t<(kMost <= 256), std::uint8_t, std::uint16_t>;
  /// At least two slots per symbol, up to 2^10 in all.
  static constexpr unsigned slot_bits(unsigned symbols) {
    return std::min(static_cast<unsigned>(std::bit_width(2 * symbols - 1)), 10u);
  }
  /// Places are below 2^15 + 64, see ArithmeticDecoder::symbol().
  static constexpr unsigned slots(unsigned bits) { return (1u << bits) + 2; }

  [[gnu::noinline]] void update() {
    constexpr std::uint32_t kMostTotal = 1u << kSymbolShift;
    counts_.total += counts_.cycle;
    if (counts_.total > kMostTotal) {
      counts_.total = 0;
      for (unsigned i = 0; i < symbols_; ++i) {
        count_[i] = static_cast<std::uint16_t>((count_[i] + 1) >> 1);
        counts_.total += count_[i];
      }
    }
    const std::uint32_t scale = 0x80000000u / counts_.total;
    std::uint32_t sum = 0;
    for (unsigned i = 0; i < symbols_; ++i) {
      first_[i] = static_cast<std::uint16_t>((scale * sum) >> (31 - kSymbolShift));
      sum += count_[i];
    }
    first_[symbols_] = 0xFFFF;
    fill_guesses();
    counts_.cycle = std::min((5 * counts_.cycle) >> 2, (symbols_ + 6) << 3);
    counts_.until_update = counts_.cycle;
  }

  void fill_guesses() {
    const unsigned end_slot = slots(kSymbolShift - slot_shift_);
    const unsigned round_up = (1u << slot_shift_) - 1;
    unsigned slot = 0;
    for (unsigned i = 0; i + 1 < symbols_; ++i) {
      const unsigned end = (first_[i + 1] + round_up) >> slot_shift_;
      for (; slot < end; ++slot) guess_[slot] = static_cast<Symbol>(i);
    }
    for (; slot < end_slot; ++slot) guess_[slot] = static_cast<Symbol>(symbols_ - 1);
  }

  std::uint32_t symbols_;
  std::uint32_t slot_shift_;
  SymbolCounts counts_;
  std::array<std::uint16_t, kMost + 1> first_;
  std::array<std::uint16_t, kMost> count_;
  std::array<Symbol, slots(slot_bits(kMost))> guess_;
};

/// A model, or an object of several models, in its state at the start of a chunk. Copying it is
/// faster than counting anew.
template <typename Model>
const Model& fresh() {
  static const Model model;
  return model;
}

template <typename Model>
void renew(Model& model) {
  model = fresh<Model>();
}
template <typename Model>
void renew(std::unique_ptr<Model>& model) {
  if (model) {
    renew(*model);
  } else {
    model = std::make_unique<Model>(fresh<Model>());
  }
}

/// A model like SymbolModel, for a single bit.
class BitModel {
 public:
  std::uint32_t zero_share() const { return zero_share_; }

  void add(unsigned bit) {
    zeros_ += 1 - bit;
    if (--until_update_ == 0) update();
  }

 private:
  void update() {
    constexpr std::uint32_t kMostTotal = 1u << kBitShift;
    total_ += cycle_;
    if (total_ > kMostTotal) {
      total_ = (total_ + 1) >> 1;
      zeros_ = (zeros_ + 1) >> 1;
      if (zeros_ == total_) ++total_;
    }
    zero_share_ = (zeros_ * (0x80000000u / total_)) >> (31 - kBitShift);
    cycle_ = std::min((5 * cycle_) >> 2, 64u);
    until_update_ = cycle_;
  }

  std::uint32_t zeros_ = 1, total_ = 2;
  std::uint32_t zero_share_ = 1u << (kBitShift - 1);
  std::uint32_t cycle_ = 4, until_update_ = 4;
};

/// The arithmetic decoder of LAZ, after A. Said, "Introduction to Arithmetic Coding - Theory and
/// Practice", HP Laboratories HPL-2004-76. Its inner loop checks no bounds: the caller provides as
/// many bytes as one point can take, which is the kMostBytes constant of each call, and kReadAhead
/// more.
///
/// Copy it into a local variable for a loop, so that the compiler keeps its state in registers.
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

/// Highest bits of a corrector that have a model; lower bits have none.
constexpr unsigned kBitsWithModel = 8;
/// Most bytes that one corrector takes: its width, its upper bits, its lower bits.
constexpr std::size_t kMostBytesInteger =
    2 * ArithmeticDecoder::kMostBytesSymbol + ArithmeticDecoder::kMostBytesBits;

/// Decodes how an integer of kBits differs from its prediction: the corrector's width k by one
/// model, and its place within [-(2^k - 1), 2^k] by another for each k.
template <unsigned kBits>
class CorrectorModel {
 public:
  using WidthModel = SymbolModel<kBits + 1>;

  CorrectorModel() {
    for (unsigned k = 1; k <= kPlaces; ++k) {
      places_[k - 1] = SymbolModel<256>(1u << std::min(k, kBitsWithModel));
    }
  }

  /// Decodes a corrector and sets `width` to its width.
  [[gnu::always_inline]] inline std::uint32_t decode(ArithmeticDecoder& decoder, WidthModel& widths,
                                                     unsigned& width) {
    const unsigned k = decoder.symbol(widths);
    width = k;
    if (k == 0) return decoder.bit(unit_);
    if (k == 32) return 0x80000000u;
    std::uint32_t place = decoder.symbol(places_[k - 1]);
    if (k > kBitsWithModel) {
      const unsigned lower = k - kBitsWithModel;
      place = place << lower | decoder.bits(lower);
    }
    const bool positive = (place >> (k - 1)) != 0;
    return place + (positive ? 1 : 1 - (1u << k));
  }

 private:
  static constexpr unsigned kPlaces = kBits < 32 ? kBits : 31;

  BitModel unit_;
  std::array<SymbolModel<256>, kPlaces> places_;
};

/// Decodes integers of kBits by their difference from a prediction, in one of kContexts contexts.
template <unsigned kBits, unsigned kContexts>
class IntegerModel {
 public:
  /// Decodes an integer: the prediction plus its corrector, modulo 2^kBits.
  [[gnu::always_inline]] inline std::uint32_t decode(ArithmeticDecoder& decoder,
                                                     std::uint32_t prediction, unsigned context) {
    const std::uint32_t value =
        prediction + corrector_.decode(decoder, widths_[context], last_width_);
    return value & kMask;
  }
  /// Width of the last decoded corrector.
  unsigned last_width() const { return last_width_; }

 private:
  static constexpr std::uint32_t kMask = 0xFFFFFFFFu >> (32 - kBits);

  unsigned last_width_ = 0;
  std::array<SymbolModel<kBits + 1>, kContexts> widths_;
  CorrectorModel<kBits> corrector_;
};

/// A model of a value below kValues, at most 256, for each value that it had in the point before.
/// Models are created when first needed.
template <unsigned kValues>
class ModelsByValueOf {
 public:
  void renew() { used_.fill(false); }

  std::uint8_t decode(ArithmeticDecoder& decoder, std::uint8_t last) {
    if (!used_[last]) start(last);
    return static_cast<std::uint8_t>(decoder.symbol(*models_[last]));
  }

 private:
  void start(std::uint8_t last) {
    laz::renew(models_[last]);
    used_[last] = true;
  }

  std::array<std::unique_ptr<SymbolModel<kValues>>, kValues> models_;
  std::array<bool, kValues> used_{};
};

using ModelsByValue = ModelsByValueOf<256>;  ///< of a byte

}  // namespace clearway::laz
