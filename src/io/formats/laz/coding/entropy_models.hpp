#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <type_traits>

/// The adaptive models of LAZ. How and when their counts become probabilities is part of the format
/// (docs/design/laz.md); how a symbol is found is not.
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
  /// Start of the symbol's range; for the symbol behind the last, a number beyond every place.
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

}  // namespace clearway::laz
