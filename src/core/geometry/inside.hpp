#pragma once

#include <cmath>
#include <cstdint>

#include "core/geometry/triangle.hpp"

/// Decides the sign of a distance: whether the surface of a solid winds around a place of the
/// model's frame (docs/design/model.md, "The definition"). The result is the same on host and
/// device.
namespace clearway {

/// A triangle of a model some of whose triangles form solids. It is a type of its own, so that
/// searches of surfaces do not ask for an inside.
struct SolidTriangle : Triangle {
  using Triangle::Triangle;
  SolidTriangle() = default;
  CLEARWAY_HD SolidTriangle(const Triangle& t) : Triangle(t) {}  // NOLINT(*-explicit-*)

  friend bool operator==(const SolidTriangle&, const SolidTriangle&) = default;
};

CLEARWAY_HD inline SolidTriangle transform(const Pose& pose, const SolidTriangle& t) {
  return transform(pose, static_cast<const Triangle&>(t));
}

/// A pose as its inverse uses it, for many points: the cofactors of its rotation and its
/// determinant.
struct PullBack {
  Vec3 rows[3];
  double determinant;
  Vec3 position;

  PullBack() = default;
  CLEARWAY_HD explicit PullBack(const Pose& pose) : position(pose.position()) {
    const double* const r = pose.rotation;
    const auto minor = [r](int a, int b, int c, int d) {
      return rounded_sum(rounded_product(r[a], r[b]), -rounded_product(r[c], r[d]));
    };
    rows[0] = {minor(4, 8, 5, 7), minor(2, 7, 1, 8), minor(1, 5, 2, 4)};
    rows[1] = {minor(5, 6, 3, 8), minor(0, 8, 2, 6), minor(2, 3, 0, 5)};
    rows[2] = {minor(3, 7, 4, 6), minor(1, 6, 0, 7), minor(0, 4, 1, 3)};
    determinant = rounded_dot(rows[0], {r[0], r[3], r[6]});
  }

  /// Pulls e back: returns x with transform(pose, x) = e, up to roundings; not finite if the
  /// rotation has no inverse.
  CLEARWAY_HD Vec3 apply(const Vec3& e) const {
    const Vec3 from_origin = difference(e, position);
    Vec3 x;
    for (int k = 0; k < 3; ++k) {
      x[k] = rounded_quotient(rounded_dot(rows[k], from_origin), determinant);
    }
    return x;
  }
};

/// Pulls e back by one pose, as PullBack does.
CLEARWAY_HD inline Vec3 pulled_back(const Pose& pose, const Vec3& e) {
  return PullBack(pose).apply(e);
}

/// Places as whole numbers: steps of a power of two from the corner of a box that holds all solids.
struct SolidLattice {
  /// Bits of a coordinate, so that what is computed from them fits 128 bits
  static constexpr int kBits = 41;

  struct Place {
    std::int64_t x, y, z;
  };

  /// Solids smaller than kLeastSide have fewer steps; those larger than kMostSide are refused.
  static constexpr double kLeastSide = 1e-150, kMostSide = 1e150;

  Box box{};
  double step = 0;       ///< metres: at most 2^-40 of the box's largest side
  double per_metre = 0;  ///< 1 / step

  SolidLattice() = default;
  explicit SolidLattice(const Box& of) : box(of) {
    const double x = of.hi.x - of.lo.x, y = of.hi.y - of.lo.y, z = of.hi.z - of.lo.z;
    const double side = std::fmax(x, std::fmax(y, z));
    const int exponent = side > kLeastSide ? std::ilogb(side) : std::ilogb(kLeastSide);
    step = std::ldexp(1.0, exponent + 1 - kBits);
    per_metre = std::ldexp(1.0, kBits - 1 - exponent);
  }

  /// Whether x lies in the box; false for NaN.
  CLEARWAY_HD bool has_in_box(const Vec3& x) const {
    return x.x >= box.lo.x && x.x <= box.hi.x && x.y >= box.lo.y && x.y <= box.hi.y &&
           x.z >= box.lo.z && x.z <= box.hi.z;
  }

  /// The nearest place of the lattice to x, which lies in the box.
  CLEARWAY_HD Place place_of(const Vec3& x) const {
    return {along(x.x, box.lo.x), along(x.y, box.lo.y), along(x.z, box.lo.z)};
  }

 private:
  CLEARWAY_HD std::int64_t along(double at, double from) const {
    const double steps = rounded_product(rounded_sum(at, -from), per_metre);
    return static_cast<std::int64_t>(rounded_sum(steps, 0.5));
  }
};

namespace inside_detail {

__extension__ using Wide = __int128;
using Place = SolidLattice::Place;

CLEARWAY_HD inline Place difference(const Place& a, const Place& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

/// Twice the area of the triangle of the origin and two places, seen along z.
CLEARWAY_HD inline Wide turn(const Place& a, const Place& b) {
  return static_cast<Wide>(a.x) * b.y - static_cast<Wide>(a.y) * b.x;
}

/// 1 or -1 if the edge from a to b passes the origin upwards or downwards in y, at a larger x;
/// otherwise 0.
CLEARWAY_HD inline int passes(const Place& a, const Place& b) {
  if ((a.y > 0) == (b.y > 0)) return 0;
  if (b.y > 0) return turn(a, b) > 0 ? 1 : 0;
  return turn(a, b) < 0 ? -1 : 0;
}

}  // namespace inside_detail

/// A triangle's contribution to the winding number of its solid around x, which is in the lattice's
/// box: 1 or -1 if the triangle is above x, by its orientation; otherwise 0.
CLEARWAY_HD inline int winding_above(const SolidLattice& lattice, const SolidLattice::Place& x,
                                     const Triangle& t) {
  using namespace inside_detail;
  const Place a = difference(lattice.place_of(t.a), x);
  const Place b = difference(lattice.place_of(t.b), x);
  const Place c = difference(lattice.place_of(t.c), x);
  if (a.z <= 0 && b.z <= 0 && c.z <= 0) return 0;
  const int around = passes(a, b) + passes(b, c) + passes(c, a);
  if (around == 0) return 0;
  const Wide volume = turn(b, c) * a.z + turn(c, a) * b.z + turn(a, b) * c.z;
  return (around > 0) == (volume > 0) && volume != 0 ? around : 0;
}

}  // namespace clearway
