#pragma once

#include <cstdint>

#include "io/formats/laz/coding/integer_model.hpp"

namespace clearway::laz {

/// The models of x and y, which point formats 0 to 5 (item version 2) and 6 to 10 share.
struct PlaneModels {
  IntegerModel<32, 2> dx;
  IntegerModel<32, 22> dy;

  /// The difference of x or y from the point before, predicted by a median. single: whether the
  /// point is the pulse's only return.
  [[gnu::always_inline]] inline std::int32_t decode_dx(ArithmeticDecoder& decoder,
                                                       std::int32_t median, bool single) {
    return static_cast<std::int32_t>(
        dx.decode(decoder, static_cast<std::uint32_t>(median), single ? 1 : 0));
  }
  [[gnu::always_inline]] inline std::int32_t decode_dy(ArithmeticDecoder& decoder,
                                                       std::int32_t median, bool single) {
    const unsigned width = dx.last_width();
    const unsigned context = (single ? 1 : 0) + (width < 20 ? width & ~1u : 20);
    return static_cast<std::int32_t>(
        dy.decode(decoder, static_cast<std::uint32_t>(median), context));
  }
  unsigned mean_width() const { return (dx.last_width() + dy.last_width()) / 2; }
};

/// The model of z, which point formats 0 to 5 (item version 2) and 6 to 10 share.
struct HeightModel {
  IntegerModel<32, 20> z;

  /// mean_width: mean width of the correctors of the same point's x and y.
  [[gnu::always_inline]] inline std::int32_t decode(ArithmeticDecoder& decoder, std::int32_t last,
                                                    bool single, unsigned mean_width) {
    const unsigned context = (single ? 1 : 0) + (mean_width < 18 ? mean_width & ~1u : 18);
    return static_cast<std::int32_t>(z.decode(decoder, static_cast<std::uint32_t>(last), context));
  }
};

/// a + b modulo 2^32.
inline std::int32_t wrapping_sum(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
}

}  // namespace clearway::laz
