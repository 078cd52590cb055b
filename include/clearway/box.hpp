#pragma once

#include <cmath>

#include "clearway/vec3.hpp"

namespace clearway {

/// Axis-aligned box in metres, closed on both sides.
struct Box {
  Vec3 lo, hi;
  friend bool operator==(const Box&, const Box&) = default;

  CLEARWAY_HD Vec3 centre() const {
    return {lo.x + 0.5 * (hi.x - lo.x), lo.y + 0.5 * (hi.y - lo.y), lo.z + 0.5 * (hi.z - lo.z)};
  }

  /// The lengths of the sides along x, y and z.
  CLEARWAY_HD Vec3 size() const { return hi - lo; }

  /// The axis of the longest side, and the first of them if several are equally long: 0 for x, 1
  /// for y, 2 for z.
  CLEARWAY_HD int longest_axis() const {
    int longest = 0;
    for (int k = 1; k < 3; ++k) {
      if (hi[k] - lo[k] > hi[longest] - lo[longest]) longest = k;
    }
    return longest;
  }

  /// Corner number 0 to 7: bit k of the number says whether it is at `hi` along axis k.
  CLEARWAY_HD Vec3 corner(unsigned number) const {
    return {(number & 1) != 0 ? hi.x : lo.x, (number & 2) != 0 ? hi.y : lo.y,
            (number & 4) != 0 ? hi.z : lo.z};
  }

  CLEARWAY_HD bool contains(const Vec3& p) const { return meets({p, p}); }

  /// Whether the boxes have a place in common; touching borders count.
  CLEARWAY_HD bool meets(const Box& other) const {
    for (int k = 0; k < 3; ++k) {
      if (!(lo[k] <= other.hi[k] && other.lo[k] <= hi[k])) return false;
    }
    return true;
  }

  /// Grows the box until it holds p. A coordinate of p that is NaN changes nothing.
  CLEARWAY_HD void extend(const Vec3& p) {
    for (int k = 0; k < 3; ++k) {
      if (p[k] < lo[k]) lo[k] = p[k];
      if (p[k] > hi[k]) hi[k] = p[k];
    }
  }

  /// The smallest box that holds both boxes.
  CLEARWAY_HD Box united(const Box& other) const {
    Box out = *this;
    for (int k = 0; k < 3; ++k) {
      if (other.lo[k] < out.lo[k]) out.lo[k] = other.lo[k];
      if (other.hi[k] > out.hi[k]) out.hi[k] = other.hi[k];
    }
    return out;
  }

  /// The box with every side moved outwards by the same length.
  CLEARWAY_HD Box grown(double by) const {
    return {{lo.x - by, lo.y - by, lo.z - by}, {hi.x + by, hi.y + by, hi.z + by}};
  }

  /// The distance between the nearest places of the two boxes; 0 where they meet.
  CLEARWAY_HD double distance(const Box& other) const {
    double squared = 0;
    for (int k = 0; k < 3; ++k) {
      const double below = other.lo[k] - hi[k], above = lo[k] - other.hi[k];
      const double apart = below > 0 ? below : above > 0 ? above : 0;
      squared += apart * apart;
    }
    return std::sqrt(squared);
  }
};

}  // namespace clearway
