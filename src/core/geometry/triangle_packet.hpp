#pragma once

#include <cstdint>

#include "core/geometry/sweep_bounds.hpp"
#include "core/geometry/triangle.hpp"
#include "core/util/macros.hpp"

namespace clearway {

/// Up to eight triangles of a model, with the values that distances to them need, so that one
/// instruction works on several. For bounds, never for answers: a distance to one of them has the
/// same error bound as that of the predicate, but its last bits differ (docs/design/numerics.md,
/// "Triangles").
struct TrianglePacket {
  static constexpr std::uint32_t kMost = 8;

  double a[3][kMost];  ///< corner a by axis; places behind `count` repeat the last triangle
  double ab[3][kMost], ac[3][kMost];
  double height[3][kMost];  ///< height over ab
  double foot[kMost];       ///< foot of the height, as a share of ab
  double per_ab[kMost];     ///< 1 / squared length of ab, which may be infinite
  double per_ac[kMost], per_bc[kMost], per_height[kMost];
  /// Square of the longest edge, plus a little that prevents underflow
  double squared_edge[kMost];
  std::uint32_t index[kMost];  ///< index of the triangle in the model's tree
  std::uint32_t count;

  /// Share of the squares of a distance and of a triangle's longest edge by which a plane across
  /// the way between the two is off, because the way is not quite the shortest.
  static constexpr double kTilt = 0x1p-21;

  /// Share of the squared lengths by which products of lengths in from_hull() round at most.
  static constexpr double kRounding = 32 * kUnitRoundoff;

  /// The place of a triangle that is nearest to a given place.
  struct Nearest {
    double squared;
    Vec3 way;  ///< vector from the triangle to the given place
  };

  void set(std::uint32_t i, const Triangle& t, std::uint32_t of) {
    using triangle_detail::along;
    const Vec3 to_b = difference(t.b, t.a), to_c = difference(t.c, t.a);
    const Vec3 bc = difference(to_c, to_b);
    const double ab2 = rounded_dot(to_b, to_b), ac2 = rounded_dot(to_c, to_c);
    const double bc2 = rounded_dot(bc, bc);
    foot[i] = rounded_dot(to_c, to_b) / ab2;
    const Vec3 over = along(to_c, -foot[i], to_b);
    for (int k = 0; k < 3; ++k) {
      a[k][i] = t.a[k];
      ab[k][i] = to_b[k];
      ac[k][i] = to_c[k];
      height[k][i] = over[k];
    }
    per_ab[i] = 1 / ab2;
    per_ac[i] = 1 / ac2;
    per_bc[i] = 1 / bc2;
    per_height[i] = 1 / rounded_dot(over, over);
    squared_edge[i] = greater_of(greater_of(ab2, ac2), bc2) + 1e-260;
    index[i] = of;
  }

  /// Copies lane `from` of another packet, or of this one, to lane i.
  void copy(std::uint32_t i, const TrianglePacket& other, std::uint32_t from) {
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
    squared_edge[i] = other.squared_edge[from];
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
  CLEARWAY_IN_CLONE CLEARWAY_HD Nearest nearest(std::uint32_t i, const Vec3& x) const {
    const Vec3 to_b{ab[0][i], ab[1][i], ab[2][i]}, to_c{ac[0][i], ac[1][i], ac[2][i]};
    const Vec3 over{height[0][i], height[1][i], height[2][i]};
    const Vec3 from_a{x.x - a[0][i], x.y - a[1][i], x.z - a[2][i]};
    const double t = dot(from_a, to_b) * per_ab[i];
    Nearest least = measured(beyond(from_a, clamped(t), to_b));
    least = nearer(least, measured(beyond(from_a, clamped(dot(from_a, to_c) * per_ac[i]), to_c)));
    const Vec3 from_b{from_a.x - to_b.x, from_a.y - to_b.y, from_a.z - to_b.z};
    const Vec3 bc{to_c.x - to_b.x, to_c.y - to_b.y, to_c.z - to_b.z};
    least = nearer(least, measured(beyond(from_b, clamped(dot(from_b, bc) * per_bc[i]), bc)));
    const double of_c = dot(beyond(from_a, t, to_b), over) * per_height[i];
    const double of_b = t - of_c * foot[i];
    Nearest face = measured(beyond(beyond(from_a, of_b, to_b), of_c, to_c));
    const bool inside = (of_c > 0) & (of_b > 0) & (of_b + of_c < 1);
    if (!inside) face.squared = kInfinity;
    return nearer(least, face);
  }

  /// Lower bound of the squared distance from triangle i to every place of some hull that includes
  /// x. It is measured along `across`, which may be any direction; the bound is close if that is
  /// the shortest way from the triangle to the hull. along: at most 0, and at most the product of
  /// `across` and any place of the hull as seen from x, less its rounding (docs/design/numerics.md,
  /// "Triangles", hulls).
  CLEARWAY_IN_CLONE CLEARWAY_HD double from_hull(std::uint32_t i, const Vec3& x,
                                                 double squared_from_x, const Vec3& across,
                                                 double along) const {
    const Vec3 from_a{x.x - a[0][i], x.y - a[1][i], x.z - a[2][i]};
    const double to_b = across.x * ab[0][i] + across.y * ab[1][i] + across.z * ab[2][i];
    const double to_c = across.x * ac[0][i] + across.y * ac[1][i] + across.z * ac[2][i];
    const double later = to_b > to_c ? to_b : to_c;
    const double farthest = later > 0 ? later : 0;
    const double length = dot(across, across);
    const double rounded = kRounding * (squared_from_x + squared_edge[i] + length);
    const double above = dot(across, from_a) - farthest + along - rounded;
    return above > 0 ? above / length * above : 0;
  }

  /// Lower bound as from_hull(), measured along the way from the triangle's nearest place to x. It
  /// costs less and is less close, unless x is the nearest place of the hull. along: that of this
  /// way.
  CLEARWAY_HD double from_nearest_hull(std::uint32_t i, double squared_from_x, double along) const {
    const double above = squared_from_x * (1 - kTilt) + along - kTilt * squared_edge[i];
    return above > 0 ? above / squared_from_x * above : 0;
  }

  CLEARWAY_HD static double dot(const Vec3& a, const Vec3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
  }

  CLEARWAY_HD static double clamped(double share) {
    const double from_0 = share > 0 ? share : 0;  // 0 for NaN, too
    return from_0 < 1 ? from_0 : 1;
  }

 private:
  CLEARWAY_HD static Vec3 beyond(const Vec3& from, double share, const Vec3& way) {
    return {from.x - share * way.x, from.y - share * way.y, from.z - share * way.z};
  }
  CLEARWAY_HD static Nearest measured(const Vec3& way) { return {dot(way, way), way}; }
  CLEARWAY_HD static Nearest nearer(const Nearest& one, const Nearest& other) {
    const bool closer = other.squared < one.squared;
    return {closer ? other.squared : one.squared,
            {closer ? other.way.x : one.way.x, closer ? other.way.y : one.way.y,
             closer ? other.way.z : one.way.z}};
  }
};

}  // namespace clearway
