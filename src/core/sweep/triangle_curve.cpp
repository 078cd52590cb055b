#include "core/sweep/triangle_curve.hpp"

#include <algorithm>

namespace clearway {

CLEARWAY_SIMD_CLONES
void TriangleCurve::to_triangles_in_vectors(const FloatPacket& packet, float* squared) const {
  const TriangleCurve curve = *this;
  float out[FloatPacket::kMost];
  curve.to_all_triangles(packet, out);
  std::copy(out, out + FloatPacket::kMost, squared);
}

CLEARWAY_SIMD_CLONES
void TriangleCurve::from_parts_in_vectors(const FloatPacket& packet, std::uint32_t i,
                                          std::uint32_t length, float per_last,
                                          float* squared) const {
  const TriangleCurve curve = *this;
  float out[kMostPlaces];
  curve.from_all_parts(packet, i, length, per_last, out);
  std::copy(out, out + kMostPlaces, squared);
}

CLEARWAY_SIMD_CLONES
void TriangleCurve::from_places_in_vectors(const FloatPacket& packet, std::uint32_t i,
                                           std::uint32_t first, float per_last,
                                           float* squared) const {
  const TriangleCurve curve = *this;
  float out[kMostPlaces];
  curve.from_all_places(packet, i, first, per_last, out);
  std::copy(out, out + kMostPlaces, squared);
}

}  // namespace clearway
