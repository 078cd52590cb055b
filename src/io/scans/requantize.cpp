#include "io/scans/requantize.hpp"

#include <cmath>
#include <limits>

namespace clearway {

std::optional<std::int32_t> quantum_at(const Quantisation& quantisation, int axis, double x) {
  using Limits = std::numeric_limits<std::int32_t>;
  const double nearest = std::nearbyint((x - quantisation.offset[axis]) / quantisation.scale[axis]);
  for (const double step : {0.0, -1.0, 1.0}) {  // because x - offset and the quotient are rounded
    const double q = nearest + step;
    if (!(q >= Limits::min() && q <= Limits::max())) continue;
    const auto whole = static_cast<std::int32_t>(q);
    if (coordinate(quantisation, axis, whole) == x) return whole;
  }
  return std::nullopt;
}

}  // namespace clearway
