#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "io/scans/laz/coding/entropy_models.hpp"

/// LAZ chooses the models of a point's coordinates by its return number and the pulse's number of
/// returns. The tables are facts of the format: docs/design/inputs.md.
namespace clearway::laz {

template <unsigned kSize>
using ReturnTable = std::array<std::array<std::uint8_t, kSize>, kSize>;

/// rows: one line for each number of returns, with one hexadecimal digit for each return number.
template <unsigned kSize>
constexpr ReturnTable<kSize> return_table(std::string_view rows) {
  ReturnTable<kSize> table{};
  for (unsigned i = 0; i < kSize * kSize; ++i) {
    const char digit = rows[i];
    table[i / kSize][i % kSize] =
        static_cast<std::uint8_t>(digit <= '9' ? digit - '0' : digit - 'a' + 10);
  }
  return table;
}

/// The table of point formats 0 to 5.
constexpr ReturnTable<8> kReturnMap10 = return_table<8>(
    "fedcba98"
    "e0136aa9"
    "d1247bba"
    "c3458ccb"
    "b6789ddc"
    "aabcdeed"
    "9abcdefe"
    "89abcdef");

/// The table of point formats 6 to 10.
constexpr ReturnTable<16> kReturnMap14 = return_table<16>(
    "0123453445555555"
    "1013333333333333"
    "2124444444433333"
    "3345444444444444"
    "4344544444444444"
    "5344454444444444"
    "3344445444444444"
    "4344444544444444"
    "4344444454444444"
    "5344444445444444"
    "5344444444544444"
    "5334444444455444"
    "5334444444455544"
    "5334444444445554"
    "5334444444444555"
    "5334444444444455");

/// The depth of a return, up to 7: the number of returns after it, or for wrong numbers by how
/// much the return number exceeds the number of returns.
constexpr unsigned return_level(unsigned returns, unsigned number) {
  const unsigned level = returns < number ? number - returns : returns - number;
  return level < 7 ? level : 7;
}

/// A running median, by which LAZ predicts differences. It holds five values in order, and each new
/// value replaces the least or the greatest. Which of the two is replaced changes when a new value
/// is not on the side where the last one was dropped.
class MedianOfFive {
 public:
  std::int32_t median() const { return values_[2]; }

  void add(std::int32_t value) {
    const std::int32_t* kept = values_.data() + (drop_greatest_ ? 0 : 1);
    drop_greatest_ = drop_greatest_ ? value < values_[2] : value <= values_[2];
    const std::array<std::int32_t, 4> old{kept[0], kept[1], kept[2], kept[3]};
    values_[0] = std::min(old[0], value);
    for (unsigned i = 1; i < 4; ++i) values_[i] = std::max(old[i - 1], std::min(old[i], value));
    values_[4] = std::max(old[3], value);
  }

 private:
  std::array<std::int32_t, 5> values_{};
  bool drop_greatest_ = true;
};

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
