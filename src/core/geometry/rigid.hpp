#pragma once

#include <span>
#include <vector>

#include "clearway/pose.hpp"
#include "core/geometry/box.hpp"

namespace clearway {

/// Tolerance of a rigid pose: its singular values are within this of 1, and its determinant is
/// positive. Printing with six digits moves them by less than 1e-5.
inline constexpr double kRigidTolerance = 1e-4;

/// Singular values of a pose's rotation, least <= greatest. Each computed value lies within a few
/// ulps of the true one, and both are widened by 1e-12 so that they bound it.
struct Stretch {
  double least;
  double greatest;
  double determinant;
};

/// The singular values and the determinant of a pose's rotation. Source: Eigen's JacobiSVD.
Stretch stretch_of(const Pose& pose);

/// An upper bound on the largest singular value of a pose's rotation, rounding included: within
/// 1e-4 of it for rigid poses and at most sqrt(3) times it for others. Far cheaper than stretch_of.
double greatest_stretch_bound(const Pose& pose);

bool is_rigid(const Stretch& stretch);

/// An upper bound, rounding included, of |transform(a, m) - transform(b, m)| over every m of the
/// box `model`, in the predicate's arithmetic. The displacement is an affine map of m, so its norm
/// is convex and the eight corners suffice (docs/design/numerics.md, "Motion").
double displacement_bound(const Box& model, const Pose& a, const Pose& b);

/// An upper bound on the rounding error of each coordinate of transform(pose, m) for every m with
/// |m_k| <= reach_k, where reach holds the largest coordinates of the model
/// (docs/design/numerics.md).
double transform_rounding(const Vec3& reach, const Pose& pose);

/// Bounds of a pose, for points m and c of a model: |R (m - c)| <= stretch |m - c|; `spread` bounds
/// the rounding of both transforms, metres.
struct PoseBound {
  double stretch;
  double spread;
};

/// The bounds of each pose for a model within a box.
std::vector<PoseBound> pose_bounds(std::span<const Pose> poses, const Box& model);

}  // namespace clearway
