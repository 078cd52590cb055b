#pragma once

#include <cmath>

#include "clearway/vec3.hpp"

/// Vectors and angles for the scenes, made of + - * / and sqrt alone, because IEEE rounds these
/// alike everywhere, which the sine of a C library does not promise.
namespace clearway::scene {

inline Vec3 normalised(const Vec3& a) { return (1 / length(a)) * a; }

inline constexpr double kPi = 3.14159265358979323846;

struct SineCosine {
  double sine, cosine;
};

/// Sine and cosine of an angle in radians, |angle| < 1e6; within 1e-12.
inline SineCosine sine_cosine(double angle) {
  constexpr double kHalfPiHigh = 1.57079632673412561417, kHalfPiLow = 6.07710050650619224932e-11;
  const double turns = std::floor(angle * (2 / kPi) + 0.5);
  const double x = (angle - turns * kHalfPiHigh) - turns * kHalfPiLow;  // |x| <= pi / 4
  const double y = x * x;
  const double s =
      x * (1 + y * (-1.0 / 6 + y * (1.0 / 120 + y * (-1.0 / 5040 +
                                                     y * (1.0 / 362880 + y * (-1.0 / 39916800))))));
  const double c =
      1 + y * (-0.5 + y * (1.0 / 24 +
                           y * (-1.0 / 720 +
                                y * (1.0 / 40320 + y * (-1.0 / 3628800 + y * (1.0 / 479001600))))));
  const auto quadrant = static_cast<long long>(turns) & 3;
  const double sine = (quadrant & 1) != 0 ? c : s;
  const double cosine = (quadrant & 1) != 0 ? s : c;
  return {(quadrant & 2) != 0 ? -sine : sine, ((quadrant + 1) & 2) != 0 ? -cosine : cosine};
}

}  // namespace clearway::scene
