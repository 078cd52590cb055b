#pragma once

#include <cstdint>

#include "clearway/vec3.hpp"
#include "core/geometry/predicate.hpp"

namespace clearway {

/// Scale and offset for each axis, metres. The position of a stored point is by definition q *
/// scale + offset in double, with each operation rounded; it is monotone in q for a scale > 0.
struct Quantisation {
  double scale[3];
  double offset[3];
  friend bool operator==(const Quantisation&, const Quantisation&) = default;
};

CLEARWAY_HD inline double coordinate(const Quantisation& quantisation, int axis, std::int32_t q) {
  return rounded_sum(rounded_product(static_cast<double>(q), quantisation.scale[axis]),
                     quantisation.offset[axis]);
}

CLEARWAY_HD inline Vec3 position(const Quantisation& quantisation, std::int32_t qx, std::int32_t qy,
                                 std::int32_t qz) {
  return {coordinate(quantisation, 0, qx), coordinate(quantisation, 1, qy),
          coordinate(quantisation, 2, qz)};
}

}  // namespace clearway
