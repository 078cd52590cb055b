#pragma once

#include <cstdint>

#include "clearway/vec3.hpp"
#include "support/scenes.hpp"

/// Distances on a way in whole numbers, for small whole coordinates. The code shares nothing with
/// the predicate, and never rounds.
namespace clearway::test {

struct WholePoint {
  std::int64_t x, y, z;

  Vec3 as_double() const {
    return {static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
  }
};

/// A random point, each of whose coordinates is from -size to size.
inline WholePoint whole_point(Random& random, std::int64_t size) {
  const auto coordinate = [&] {
    return static_cast<std::int64_t>(below(random, static_cast<std::uint64_t>(2 * size + 1))) -
           size;
  };
  return {coordinate(), coordinate(), coordinate()};
}

inline WholePoint operator-(const WholePoint& a, const WholePoint& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

inline std::int64_t dot(const WholePoint& a, const WholePoint& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// The least squared distance of a point to the segment from a to b, both included, as a fraction.
struct ExactWay {
  std::int64_t over;
  std::int64_t under = 1;

  ExactWay(const WholePoint& e, const WholePoint& a, const WholePoint& b) {
    const WholePoint ae = e - a, ab = b - a;
    const std::int64_t n = dot(ae, ab), length = dot(ab, ab);
    if (n <= 0) {
      over = dot(ae, ae);
    } else if (n >= length) {
      over = dot(e - b, e - b);
    } else {
      over = dot(ae, ae) * length - n * n;
      under = length;
    }
  }

  /// Whether the squared distance is below the square of quarters / 4.
  bool is_within(std::int64_t quarters) const { return 16 * over < quarters * quarters * under; }
  /// Whether the squared distance equals the square of quarters / 4 and comes from a quotient that
  /// double may have to round.
  bool is_rounded_tie(std::int64_t quarters) const {
    return 16 * over == quarters * quarters * under && (under & (under - 1)) != 0;
  }
};

}  // namespace clearway::test
