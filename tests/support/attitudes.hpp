#pragma once

#include <array>
#include <cmath>

namespace clearway::test {

/// A 3 x 3 matrix, row-major.
using Rotation = std::array<double, 9>;

inline Rotation operator*(const Rotation& a, const Rotation& b) {
  Rotation product{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      for (std::size_t k = 0; k < 3; ++k) {
        product[3 * row + column] += a[3 * row + k] * b[3 * k + column];
      }
    }
  }
  return product;
}

inline Rotation about_x(double a) {
  return {1, 0, 0, 0, std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a)};
}
inline Rotation about_y(double a) {
  return {std::cos(a), 0, std::sin(a), 0, 1, 0, -std::sin(a), 0, std::cos(a)};
}
inline Rotation about_z(double a) {
  return {std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a), 0, 0, 0, 1};
}

/// The rotation of navigation's angles, radians, as the textbooks define them: from forward, right,
/// down turn by roll, then pitch, then heading into north, east, down. Both frames are then turned
/// into Clearway's: forward, left, up and east, north, up.
inline Rotation navigation_rotation(double roll, double pitch, double heading) {
  const Rotation enu_of_ned{0, 1, 0, 1, 0, 0, 0, 0, -1};
  const Rotation frd_of_flu{1, 0, 0, 0, -1, 0, 0, 0, -1};
  return enu_of_ned * about_z(heading) * about_y(pitch) * about_x(roll) * frd_of_flu;
}

inline double greatest_difference(const Rotation& a, const double* b) {
  double worst = 0;
  for (std::size_t k = 0; k < 9; ++k) worst = std::max(worst, std::abs(a[k] - b[k]));
  return worst;
}

}  // namespace clearway::test
