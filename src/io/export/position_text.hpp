#pragma once

#include <array>
#include <string_view>

#include "io/export/decimal_axis.hpp"

namespace clearway {

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
