#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/geometry/quantisation.hpp"

namespace clearway {

/// Writes the coordinates of one axis as decimals: 14.78 where the double is 14.780000000000001,
/// because scale and offset are decimals themselves. A text reads back as a number x for which
/// nearbyint((x - offset) / scale) is the stored integer. Where that is impossible, it has the
/// shortest digits that give the double back.
class DecimalAxis {
 public:
  DecimalAxis(const Quantisation& quantisation, int axis);

  /// The text of a coordinate, valid until the next call.
  std::string_view text(double coordinate);

 private:
  std::string_view decimal(std::int32_t quantum);

  const Quantisation quantisation_;
  int axis_;
  /// Scale and offset in units of 10^-digits_; nullopt where these are not whole numbers.
  std::optional<std::array<std::int64_t, 2>> whole_;
  int digits_ = 0;
  std::array<char, 64> buffer_{};
};

/// Writes positions as three numbers with a separator between them.
class PositionText {
 public:
  explicit PositionText(const Quantisation& quantisation)
      : axes_{DecimalAxis(quantisation, 0), DecimalAxis(quantisation, 1),
              DecimalAxis(quantisation, 2)} {}

  template <typename Text>
  void write(Text& out, const Vec3& p, std::string_view between) {
    out << axes_[0].text(p.x) << between << axes_[1].text(p.y) << between << axes_[2].text(p.z);
  }

 private:
  std::array<DecimalAxis, 3> axes_;
};

}  // namespace clearway
