#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "io/formats/laz/coding/arithmetic_decoder.hpp"

namespace clearway::laz {

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

}  // namespace clearway::laz
