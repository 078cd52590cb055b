#pragma once

#include <cstdint>
#include <type_traits>

#include "core/geometry/sweep_bounds.hpp"
#include "core/geometry/triangle.hpp"
#include "core/util/macros.hpp"

namespace clearway {

/// A vector of floats.
struct FloatVector {
  float x, y, z;
};

/// Up to kLanes triangles of a model, with the values that distances to them need, so that one
/// instruction works on several. For bounds, never for answers: a distance to one of them has the
/// same error bound as that of the predicate, in terms of the roundoff of Real, but its last bits
/// differ (docs/design/numerics.md, "Triangles").
template <typename RealType, std::uint32_t kLanes>
struct TrianglePacketOf {
  using Real = RealType;
  static constexpr std::uint32_t kMost = kLanes;

  using Vector = std::conditional_t<std::is_same_v<Real, double>, Vec3, FloatVector>;

  Real a[3][kMost];  ///< corner a by axis; places beyond `count` repeat the last triangle
  Real ab[3][kMost], ac[3][kMost];
  Real height[3][kMost];  ///< height over ab
  Real foot[kMost];       ///< foot of the height, as a share of ab
  Real per_ab[kMost];     ///< 1 / squared length of ab, which may be infinite
  Real per_ac[kMost], per_bc[kMost], per_height[kMost];
  std::uint32_t index[kMost];  ///< index of the triangle in the model's tree
  std::uint32_t count;

  /// The place of a triangle that is nearest to a given place.
  struct Nearest {
    Real squared;
    Vector way;  ///< vector from the triangle to the given place
  };

  /// Sets triangle i. Its edges are rounded to Real, and all else belongs to the triangle that they
  /// then make.
  void set(std::uint32_t i, const Triangle& t, std::uint32_t of) {
    using triangle_detail::along;
    const Vec3 to_b = as_real(difference(t.b, t.a)), to_c = as_real(difference(t.c, t.a));
    const Vec3 bc = difference(to_c, to_b);
    const double ab2 = rounded_dot(to_b, to_b);
    const double share = rounded_dot(to_c, to_b) / ab2;
    const Vec3 over = along(to_c, -share, to_b);
    for (int k = 0; k < 3; ++k) {
      a[k][i] = static_cast<Real>(t.a[k]);
      ab[k][i] = static_cast<Real>(to_b[k]);
      ac[k][i] = static_cast<Real>(to_c[k]);
      height[k][i] = static_cast<Real>(over[k]);
    }
    foot[i] = static_cast<Real>(share);
    per_ab[i] = static_cast<Real>(1 / ab2);
    per_ac[i] = static_cast<Real>(1 / rounded_dot(to_c, to_c));
    per_bc[i] = static_cast<Real>(1 / rounded_dot(bc, bc));
    per_height[i] = static_cast<Real>(1 / rounded_dot(over, over));
    index[i] = of;
  }

  /// Copies lane `from` of another packet, or of this one, to lane i.
  void copy(std::uint32_t i, const TrianglePacketOf& other, std::uint32_t from) {
    for (int k = 0; k < 3; ++k) {
      a[k][i] = other.a[k][from];
      ab[k][i] = other.ab[k][from];
      ac[k][i] = other.ac[k][from];
      height[k][i] = other.height[k][from];
    }
    foot[i] = other.foot[from];
    per_ab[i] = other.per_ab[from];
    per_ac[i] = other.per_ac[from];
    per_bc[i] = other.per_bc[from];
    per_height[i] = other.per_height[from];
    index[i] = other.index[from];
  }

  /// Ends the packet after `used` triangles, at least one, and fills the rest with the last of
  /// them.
  void close(std::uint32_t used) {
    count = used;
    for (std::uint32_t i = used; i < kMost; ++i) copy(i, *this, used - 1);
  }

  CLEARWAY_HD std::uint32_t element(std::uint32_t i) const { return index[i]; }

  /// The nearest place of triangle i to x. Computed like the predicate, but with the ends of edges
  /// as feet, and with products instead of quotients.
  CLEARWAY_IN_CLONE CLEARWAY_HD Nearest nearest(std::uint32_t i, const Vector& x) const {
    const Vector to_b = vector(ab, i), to_c = vector(ac, i), over = vector(height, i);
    const Vector from_a = from_corner(i, x);
    const Real t = dot(from_a, to_b) * per_ab[i];
    Nearest least = measured(beyond(from_a, clamped(t), to_b));
    least = nearer(least, measured(beyond(from_a, clamped(dot(from_a, to_c) * per_ac[i]), to_c)));
    const Vector from_b{from_a.x - to_b.x, from_a.y - to_b.y, from_a.z - to_b.z};
    const Vector bc{to_c.x - to_b.x, to_c.y - to_b.y, to_c.z - to_b.z};
    least = nearer(least, measured(beyond(from_b, clamped(dot(from_b, bc) * per_bc[i]), bc)));
    const Real of_c = dot(beyond(from_a, t, to_b), over) * per_height[i];
    const Real of_b = t - of_c * foot[i];
    Nearest face = measured(beyond(beyond(from_a, of_b, to_b), of_c, to_c));
    const bool inside = (of_c > 0) & (of_b > 0) & (of_b + of_c < 1);
    if (!inside) face.squared = static_cast<Real>(kInfinity);
    return nearer(least, face);
  }

  /// The vector from corner a of triangle i to x.
  CLEARWAY_IN_CLONE CLEARWAY_HD Vector from_corner(std::uint32_t i, const Vector& x) const {
    return {x.x - a[0][i], x.y - a[1][i], x.z - a[2][i]};
  }

  /// The vector from x to about the centre of triangle i.
  CLEARWAY_IN_CLONE CLEARWAY_HD Vector centre_from(std::uint32_t i, const Vector& x) const {
    constexpr Real kThird = static_cast<Real>(1.0 / 3);
    return {a[0][i] - x.x + kThird * (ab[0][i] + ac[0][i]),
            a[1][i] - x.y + kThird * (ab[1][i] + ac[1][i]),
            a[2][i] - x.z + kThird * (ab[2][i] + ac[2][i])};
  }

  /// The greatest product of v and any place of triangle i as seen from corner a; at least 0.
  CLEARWAY_IN_CLONE CLEARWAY_HD Real farthest_along(std::uint32_t i, const Vector& v) const {
    const Real to_b = dot(v, vector(ab, i)), to_c = dot(v, vector(ac, i));
    const Real later = to_b > to_c ? to_b : to_c;
    return later > 0 ? later : 0;
  }

  CLEARWAY_IN_CLONE CLEARWAY_HD static Real dot(const Vector& a, const Vector& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
  }

  CLEARWAY_IN_CLONE CLEARWAY_HD static Real clamped(Real share) {
    const Real from_0 = share > 0 ? share : 0;  // 0 for NaN, too
    return from_0 < 1 ? from_0 : 1;
  }

 private:
  static Vec3 as_real(const Vec3& v) {
    return {static_cast<double>(static_cast<Real>(v.x)),
            static_cast<double>(static_cast<Real>(v.y)),
            static_cast<double>(static_cast<Real>(v.z))};
  }
  CLEARWAY_IN_CLONE CLEARWAY_HD static Vector vector(const Real (&of)[3][kMost], std::uint32_t i) {
    return {of[0][i], of[1][i], of[2][i]};
  }
  CLEARWAY_IN_CLONE CLEARWAY_HD static Vector beyond(const Vector& from, Real share,
                                                     const Vector& way) {
    return {from.x - share * way.x, from.y - share * way.y, from.z - share * way.z};
  }
  CLEARWAY_IN_CLONE CLEARWAY_HD static Nearest measured(const Vector& way) {
    return {dot(way, way), way};
  }
  CLEARWAY_IN_CLONE CLEARWAY_HD static Nearest nearer(const Nearest& one, const Nearest& other) {
    const bool closer = other.squared < one.squared;
    return {closer ? other.squared : one.squared,
            {closer ? other.way.x : one.way.x, closer ? other.way.y : one.way.y,
             closer ? other.way.z : one.way.z}};
  }
};

using TrianglePacket = TrianglePacketOf<double, 8>;

/// Up to 16 triangles in floats, seen from a place in their midst, so that a float is wrong by a
/// ten-millionth of their size. A vector of the processor holds twice as many floats as doubles.
struct FloatPacket : TrianglePacketOf<float, 16> {
  Vec3 origin;  ///< the place that all coordinates are relative to
  /// Bound, for any corner and any edge from it, on the sum of the magnitudes of all their
  /// coordinates
  float size;
  float edge;  ///< bound on the length of any edge

  /// triangles: `used` of them, at least one. first: the index of the first of them in the model's
  /// tree.
  static FloatPacket of(const Triangle* triangles, std::uint32_t used, std::uint32_t first);

  /// Bound, in metres, on the error of distances to these triangles that are computed in floats
  /// from places of a curve. of_curve: sum of the magnitudes of the curve's coordinates, seen from
  /// the origin. Infinite if products of lengths may overflow (docs/design/numerics.md,
  /// "Triangles", floats).
  CLEARWAY_HD float slack(float of_curve) const {
    const float both = size + of_curve;
    return both < kMostSize ? both * 0x1p-18F + edge * 0x1p-16F + kLeastSlack
                            : static_cast<float>(kInfinity);
  }

 private:
  static constexpr float kMostSize = 1e15F;
  /// Covers products of lengths that are lost to underflow.
  static constexpr float kLeastSlack = 1e-17F;
};

}  // namespace clearway
