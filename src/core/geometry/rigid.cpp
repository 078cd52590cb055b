#include "core/geometry/rigid.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/predicate.hpp"
#include "core/geometry/sweep_bounds.hpp"

namespace clearway {
namespace {

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

}  // namespace

Stretch stretch_of(const Pose& pose) {
  constexpr double kSlack = 1e-12;
  const RowMajor matrix = Eigen::Map<const RowMajor>(pose.rotation);
  const Eigen::Vector3d values = Eigen::JacobiSVD<Eigen::Matrix3d>(matrix).singularValues();
  return {std::max(0.0, values[2] - kSlack * values[0]), values[0] * (1 + kSlack),
          matrix.determinant()};
}

double greatest_stretch_bound(const Pose& pose) {
  // The largest row sum of |R^T R|, which is a norm of a symmetric matrix, bounds its largest
  // eigenvalue.
  const double* r = pose.rotation;
  double greatest = 0;
  for (int i = 0; i < 3; ++i) {
    double sum = 0;
    for (int j = 0; j < 3; ++j) {
      sum += std::abs(r[i] * r[j] + r[3 + i] * r[3 + j] + r[6 + i] * r[6 + j]);
    }
    greatest = std::isnan(sum) ? std::numeric_limits<double>::infinity() : std::max(greatest, sum);
  }
  // 12 u covers the rounding of the nine products and their sums, 1e-150 their underflow.
  return std::sqrt(greatest) * (1 + 32 * kUnitRoundoff) + 1e-150;
}

bool is_rigid(const Stretch& stretch) {
  return stretch.determinant > 0 && stretch.least >= 1 - kRigidTolerance &&
         stretch.greatest <= 1 + kRigidTolerance;
}

double transform_rounding(const Vec3& reach, const Pose& pose) {
  // Three products and three sums make at most 4 roundings on any path, each relative to at most
  // the sum of magnitudes; 6 u covers the second-order terms.
  double worst = 0;
  for (int k = 0; k < 3; ++k) {
    const double* row = pose.rotation + 3 * k;
    const double magnitude = std::abs(row[0]) * reach.x + std::abs(row[1]) * reach.y +
                             std::abs(row[2]) * reach.z + std::abs(pose.translation[k]);
    worst = std::max(worst, magnitude);
  }
  return 6 * kUnitRoundoff * worst;
}

double displacement_bound(const Box& model, const Pose& a, const Pose& b) {
  double greatest = 0;
  for (unsigned i = 0; i < 8; ++i) {
    const Vec3 m = model.corner(i);
    greatest = std::max(greatest, squared_distance(transform(a, m), transform(b, m)));
  }
  const Vec3 reach = reach_of(model);
  // The transforms of the corners, and those of the model points between them, err by this much
  // each.
  const double rounding = transform_rounding(reach, a) + transform_rounding(reach, b);
  return std::sqrt(greatest) * (1 + 8 * kUnitRoundoff) + 2 * std::sqrt(3.0) * rounding * 1.01;
}

std::vector<PoseBound> pose_bounds(std::span<const Pose> poses, const Box& model) {
  const Vec3 reach = reach_of(model);
  std::vector<PoseBound> bounds;
  bounds.reserve(poses.size());
  for (const Pose& pose : poses) {
    bounds.push_back({greatest_stretch_bound(pose),
                      2 * std::sqrt(3.0) * 1.01 * transform_rounding(reach, pose)});
  }
  return bounds;
}

}  // namespace clearway
