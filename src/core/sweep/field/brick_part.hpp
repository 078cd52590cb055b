#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/geometry/box.hpp"
#include "core/geometry/predicate.hpp"
#include "core/sweep/field/model_field_ref.hpp"

namespace clearway {

/// All positions within `half` of `centre` along each axis.
struct BrickPlace {
  Vec3 centre, half;
};

/// A part of a brick: nodes first[k] to last[k], both included, along each axis.
struct BrickPart {
  std::uint32_t first[3], last[3];

  BrickPart octant(int index) const {
    BrickPart inner = *this;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t middle = (first[k] + last[k]) / 2;
      if ((index >> k & 1) != 0) {
        inner.first[k] = middle + 1;
      } else {
        inner.last[k] = middle;
      }
    }
    return inner;
  }

  template <typename Visit>
  void for_each_node(Visit visit) const {
    for (std::uint32_t z = first[2]; z <= last[2]; ++z) {
      for (std::uint32_t y = first[1]; y <= last[1]; ++y) {
        for (std::uint32_t x = first[0]; x <= last[0]; ++x) visit(x, y, z);
      }
    }
  }
};

/// Where a brick lies. corner: its first node; voxel: metres from a node to the next.
struct BrickLattice {
  Vec3 corner;
  double voxel;

  Vec3 node(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return {corner.x + x * voxel, corner.y + y * voxel, corner.z + z * voxel};
  }

  BrickPlace place_of(const BrickPart& part) const {
    const Vec3 lo = node(part.first[0], part.first[1], part.first[2]);
    const Vec3 hi = node(part.last[0], part.last[1], part.last[2]);
    return {{(lo.x + hi.x) / 2, (lo.y + hi.y) / 2, (lo.z + hi.z) / 2},
            {(hi.x - lo.x) / 2, (hi.y - lo.y) / 2, (hi.z - lo.z) / 2}};
  }
};

/// A place of the model near some positions, against which other places are tested. A place p is
/// nearer than `near` to some position x within `half` of `centre` only if
///     |centre - p|^2 - |centre - near|^2 < 2 sum half_k |p_k - near_k|,
/// because |x - p|^2 - |x - near|^2 is linear in x.
struct BrickRival {
  /// Share by which the test is widened, far more than its roundings amount to: a field's voxel is
  /// at least 1e-7 of the model's coordinates.
  static constexpr double kSlack = 1e-6;

  Vec3 centre, half, near;
  double limit;  ///< |centre - near|^2 plus the slack

  BrickRival(const BrickPlace& place, const Vec3& near_place)
      : centre(place.centre),
        half(place.half),
        near(near_place),
        limit(squared_distance(centre, near_place)) {
    limit += kSlack * (limit + squared_length(half.x, half.y, half.z));
  }

  bool leaves(const Vec3& p) const {
    const double gain = half.x * std::abs(p.x - near.x) + half.y * std::abs(p.y - near.y) +
                        half.z * std::abs(p.z - near.z);
    return !(squared_distance(centre, p) - 2 * gain > limit);  // true for NaN, too
  }

  /// Whether leaves() may be true for some place of the box. What leaves() adds up is least, along
  /// each axis, at the place nearest to centre + half above near, and to centre - half below it.
  bool leaves_any(const Box& box) const {
    double least = 0;
    for (int k = 0; k < 3; ++k) {
      const auto at = [&](double p) {
        return (p - centre[k]) * (p - centre[k]) - 2 * half[k] * std::abs(p - near[k]);
      };
      const double above = std::clamp(centre[k] + half[k], box.lo[k], box.hi[k]);
      const double below = std::clamp(centre[k] - half[k], box.lo[k], box.hi[k]);
      least += std::min(at(above), at(below));
    }
    return !(least > limit);
  }
};

/// A float not above the true square: one rounding to float and a few in double are taken off.
inline float rounded_down(double squared) {
  return std::nextafterf(static_cast<float>(squared * (1 - 1e-12)), 0.0F);
}

/// Results for the nodes of a brick: ModelFieldRef::kBrickNodes values in each array, [z][y][x].
struct BrickNodes {
  float* squared = nullptr;  ///< squared distances, rounded down
  std::uint32_t* nearest = nullptr;

  void keep(std::uint32_t x, std::uint32_t y, std::uint32_t z, double squared_distance,
            std::uint32_t element) const {
    const std::size_t at = (z * ModelFieldRef::kRow + y) * ModelFieldRef::kRow + x;
    squared[at] = rounded_down(squared_distance);
    nearest[at] = element;
  }
};

}  // namespace clearway
