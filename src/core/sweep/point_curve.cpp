#include "core/sweep/point_curve.hpp"

#include "core/util/macros.hpp"

namespace clearway {

CLEARWAY_SIMD_CLONES
void PointCurve::to_points_in_vectors(const PointPacket& packet, double* squared) const {
  const PointCurve curve = *this;
  curve.to_all_points(packet, squared);
}

}  // namespace clearway
