#include "core/sweep/triangle_curve.hpp"

namespace clearway {

CLEARWAY_SIMD_CLONES
void TriangleCurve::to_triangles_in_vectors(const TrianglePacket& packet, double* squared) const {
  const TriangleCurve curve = *this;
  curve.to_all_triangles(packet, squared);
}

CLEARWAY_SIMD_CLONES
void TriangleCurve::from_parts_in_vectors(const TrianglePacket& packet, std::uint32_t i,
                                          std::uint32_t length, double per_last,
                                          double* squared) const {
  const TriangleCurve curve = *this;
  TrianglePacket one;
  one.copy(0, packet, i);
  curve.from_all_parts(one, 0, length, per_last, squared);
}

CLEARWAY_SIMD_CLONES
void TriangleCurve::from_places_in_vectors(const TrianglePacket& packet, std::uint32_t i,
                                           std::uint32_t first, double per_last,
                                           double* squared) const {
  const TriangleCurve curve = *this;
  TrianglePacket one;
  one.copy(0, packet, i);
  curve.from_all_places(one, 0, first, per_last, squared);
}

}  // namespace clearway
