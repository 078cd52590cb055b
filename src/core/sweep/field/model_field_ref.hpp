#pragma once

#include <cstdint>

#include "core/geometry/box.hpp"
#include "core/geometry/sweep_bounds.hpp"
#include "core/sweep/field/field_inside_ref.hpp"
#include "core/util/macros.hpp"

namespace clearway {

class ModelField;

/// View of a ModelField on the host or on a device. Does not own it. Lattice nodes hold squared
/// distances, rounded down.
struct ModelFieldRef {
  static constexpr std::uint32_t kBrick = 8;  ///< fine voxels along the side of a coarse cell
  static constexpr std::uint32_t kRow = kBrick + 1;
  static constexpr std::uint32_t kBrickNodes = kRow * kRow * kRow;
  static constexpr std::uint32_t kNoBrick = 0xffffffff;
  /// Bit of a brick's number that is set while the brick is not made
  static constexpr std::uint32_t kToBeMade = 0x80000000;
  static constexpr std::uint32_t kNone = 0xffffffff;
  /// Bound on the squared distance from a place of a voxel to its nearest node, in squared voxels.
  static constexpr double kNearNode = 0.76;

  struct Bounds {
    double squared_lower;  ///< at most d_M^2; the lattice's rounding slack is taken off
    std::uint32_t near;    ///< a model element near x, or kNone; with a reach never kNone
  };

  Box model;              ///< box of the whole model
  double coarse;          ///< step of the coarse lattice, metres
  double voxel;           ///< step of the fine lattice, metres: coarse / kBrick
  double per_metre;       ///< 1 / coarse
  double coarse_slack;    ///< share that concave_bound() takes off in the coarse lattice
  double fine_slack;      ///< share that concave_bound() takes off in the fine lattice
  Vec3 origin;            ///< first node of the coarse lattice
  std::uint32_t size[3];  ///< number of coarse nodes along each axis
  std::uint32_t bricks;
  const float* coarse_squared;          ///< squared distances of coarse nodes [z][y][x]
  const std::uint32_t* coarse_nearest;  ///< nearest elements of coarse nodes [z][y][x], or null
  const std::uint32_t* brick_of;        ///< brick of each coarse cell, [z][y][x]
  const float* distances;               ///< squared distances of bricks, each [z][y][x]
  const std::uint32_t* nearest;         ///< nearest elements of bricks, each [z][y][x]
  /// Makes bricks that are asked for, on the host; null: no look-up makes any
  const ModelField* by_need;
  FieldInsideRef inside;  ///< empty for a model without solids

  CLEARWAY_HD std::size_t coarse_nodes() const { return std::size_t{size[0]} * size[1] * size[2]; }

  CLEARWAY_HD Bounds bounds(const Vec3& x) const { return look_up<true>(x); }

  /// The bound alone; that saves reading the elements.
  CLEARWAY_HD double squared_lower(const Vec3& x) const { return look_up<false>(x).squared_lower; }

  /// Whether a solid contains x, if bounds() proves x to be farther from the surface than the
  /// roundings of this question (docs/design/numerics.md, "Solids"). squared_lower: from bounds().
  CLEARWAY_HD bool contains(const Vec3& x, double squared_lower) const;

  /// The brick of a coarse cell, or kNoBrick. Makes it if that is still to be done.
  CLEARWAY_HD std::uint32_t brick_at(std::size_t cell) const;

 private:
  template <bool kNames>
  CLEARWAY_HD Bounds look_up(const Vec3& x) const;
  CLEARWAY_HD std::uint32_t made_brick_at(std::size_t cell) const;
  CLEARWAY_HD std::uint32_t near_coarse_node(const double (&place)[3]) const;
};

// ---- implementation

namespace field_detail {

/// Trilinear interpolation: sum w_k f_k over the corners of a cell, in the order x, then y, then z.
CLEARWAY_IN_CLONE CLEARWAY_HD inline double interpolated(const double (&f)[3],
                                                         const double (&corner)[8]) {
  double along_x[4];
  for (int i = 0; i < 4; ++i) {
    along_x[i] = (1 - f[0]) * corner[2 * i] + f[0] * corner[2 * i + 1];
  }
  const double low = (1 - f[1]) * along_x[0] + f[1] * along_x[1];
  const double high = (1 - f[1]) * along_x[2] + f[1] * along_x[3];
  return (1 - f[2]) * low + f[2] * high;
}

/// Loads the eight corners of a cell. first: its first corner; row, layer: steps to the next y and
/// z.
CLEARWAY_HD inline void load_corners(const float* first, std::size_t row, std::size_t layer,
                                     double (&corner)[8]) {
  for (int i = 0; i < 4; ++i) {
    const float* at = first + (i & 1 ? row : 0) + (i & 2 ? layer : 0);
    corner[2 * i] = static_cast<double>(at[0]);
    corner[2 * i + 1] = static_cast<double>(at[1]);
  }
}

/// Lower bound on d_M^2 from an interpolated value. d_M^2(x) - |x|^2 is a minimum of linear
/// functions of x, hence concave, so the interpolation of d^2 exceeds d^2 by at most step^2 sum f
/// (1 - f). The last term covers the rounding of this computation and the errors of the nodes.
CLEARWAY_IN_CLONE CLEARWAY_HD inline double concave_bound(double mean, const double (&f)[3],
                                                          double step, double slack) {
  const double bend = f[0] * (1 - f[0]) + f[1] * (1 - f[1]) + f[2] * (1 - f[2]);
  const double excess = step * step * bend;
  const double bound = mean - excess - (mean + step * step) * slack;
  return bound > 0 ? bound : 0;
}

}  // namespace field_detail

/// The nearest element of the coarse node that is nearest to `place`, which is given in coarse
/// steps from the origin and may lie anywhere.
CLEARWAY_HD inline std::uint32_t ModelFieldRef::near_coarse_node(const double (&place)[3]) const {
  if (coarse_nearest == nullptr) return kNone;
  std::size_t at = 0;
  for (int k = 2; k >= 0; --k) {
    const double last = size[k] - 1;
    const double rounded = place[k] + 0.5;
    const double node = place[k] > 0 ? (rounded < last ? rounded : last) : 0;
    at = at * size[k] + static_cast<std::size_t>(node);
  }
  return coarse_nearest[at];
}

/// Calls ModelField::made_brick().
std::uint32_t make_brick_of(const ModelField& field, std::size_t cell);

CLEARWAY_HD inline std::uint32_t ModelFieldRef::brick_at(std::size_t cell) const {
#ifdef __CUDA_ARCH__
  return brick_of[cell];
#else
  const std::uint32_t brick = __atomic_load_n(brick_of + cell, __ATOMIC_ACQUIRE);
  if (brick < kToBeMade || brick == kNoBrick) return brick;
  return by_need != nullptr ? make_brick_of(*by_need, cell) : kNoBrick;
#endif
}

/// kNames: whether to name a near element.
template <bool kNames>
CLEARWAY_HD inline ModelFieldRef::Bounds ModelFieldRef::look_up(const Vec3& x) const {
  using namespace field_detail;
  const double whole[3] = {(x.x - origin.x) * per_metre, (x.y - origin.y) * per_metre,
                           (x.z - origin.z) * per_metre};
  for (int k = 0; k < 3; ++k) {
    if (!(whole[k] >= 0 && whole[k] < size[k] - 1)) {
      return {least_squared_distance(model, x), kNames ? near_coarse_node(whole) : kNone};
    }
  }
  std::uint32_t cell[3];
  double place[3], corner[8];
  for (int k = 0; k < 3; ++k) {
    cell[k] = static_cast<std::uint32_t>(whole[k]);
    place[k] = whole[k] - cell[k];
  }
  const std::size_t at = (std::size_t{cell[2]} * size[1] + cell[1]) * size[0] + cell[0];
  const std::uint32_t brick = brick_at(at);
  if (brick == kNoBrick) {
    load_corners(coarse_squared + at, size[0], std::size_t{size[0]} * size[1], corner);
    return {concave_bound(interpolated(place, corner), place, coarse, coarse_slack),
            kNames ? near_coarse_node(whole) : kNone};
  }
  std::uint32_t fine[3], round[3];
  for (int k = 0; k < 3; ++k) {
    place[k] *= kBrick;
    fine[k] = static_cast<std::uint32_t>(place[k]);
    if (fine[k] > kBrick - 1) fine[k] = kBrick - 1;
    place[k] -= fine[k];
    round[k] = fine[k] + (place[k] >= 0.5 ? 1 : 0);
  }
  const std::size_t first = std::size_t{brick} * kBrickNodes;
  load_corners(distances + first + (fine[2] * kRow + fine[1]) * kRow + fine[0], kRow, kRow * kRow,
               corner);
  return {concave_bound(interpolated(place, corner), place, voxel, fine_slack),
          kNames ? nearest[first + (round[2] * kRow + round[1]) * kRow + round[0]] : kNone};
}

CLEARWAY_HD inline std::uint32_t ModelFieldRef::made_brick_at(std::size_t cell) const {
#ifdef __CUDA_ARCH__
  return brick_of[cell];
#else
  return __atomic_load_n(brick_of + cell, __ATOMIC_ACQUIRE);
#endif
}

/// If the node nearest to x is nearer than the surface, no wall lies between them, so the node's
/// answer holds for x.
CLEARWAY_HD inline bool ModelFieldRef::contains(const Vec3& x, double squared_lower) const {
  if (!inside.solids.lattice.has_in_box(x)) return false;
  const double whole[3] = {(x.x - origin.x) * per_metre, (x.y - origin.y) * per_metre,
                           (x.z - origin.z) * per_metre};
  std::uint32_t cell[3], node[3];
  for (int k = 0; k < 3; ++k) {
    if (!(whole[k] >= 0 && whole[k] < size[k] - 1)) return inside.solids.contains(x);
    cell[k] = static_cast<std::uint32_t>(whole[k]);
    const double rounded = (whole[k] - cell[k]) * kBrick + 0.5;
    node[k] = static_cast<std::uint32_t>(rounded);
  }
  const std::size_t at = (std::size_t{cell[2]} * size[1] + cell[1]) * size[0] + cell[0];
  const std::uint32_t brick = made_brick_at(at);
  if (brick == kNoBrick) return inside.cells[at] != 0;
  if (brick >= kToBeMade || squared_lower <= kNearNode * voxel * voxel) {
    return inside.solids.contains(x);
  }
  constexpr std::uint32_t kWords = FieldInsideRef::words_for(kBrickNodes);
  return inside.node(std::size_t{brick} * kWords, (node[2] * kRow + node[1]) * kRow + node[0]);
}

}  // namespace clearway
