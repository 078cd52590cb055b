#include "core/sweep/triangle_curve.hpp"

#include "core/util/macros.hpp"

namespace clearway {

CLEARWAY_SIMD_CLONES
void TriangleCurve::to_triangles_in_vectors(const TrianglePacket& packet, double* squared) const {
  const TriangleCurve curve = *this;
  curve.to_all_triangles(packet, squared);
}

}  // namespace clearway
