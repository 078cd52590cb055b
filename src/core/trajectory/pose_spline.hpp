#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "clearway/pose.hpp"

namespace clearway {

/// The positions of a PoseCurve, without its rotations.
class PositionCurve {
 public:
  /// Velocity in metres per unit of the parameter, 0 <= t <= 1.
  Eigen::Vector3d velocity(double t) const {
    const double rest = 1 - t;
    return 3 * (rest * rest * moves_[0] + 2 * t * rest * moves_[1] + t * t * moves_[2]);
  }

  /// How far the curve has gone from its first position at 0 <= t <= 1, in metres.
  Eigen::Vector3d displacement(double t) const {
    const double rest = 1 - t;
    return (1 - rest * rest * rest) * moves_[0] + t * t * (3 - 2 * t) * moves_[1] +
           t * t * t * moves_[2];
  }

 private:
  friend class PoseSpline;

  std::array<Eigen::Vector3d, 3> moves_;  ///< metres
};

/// The curve from pose i to the next: a cubic in position, a cumulative cubic in rotation. With the
/// cumulative Bernstein polynomials b_1 = 1 - (1 - t)^3, b_2 = 3 t^2 - 2 t^3 and b_3 = t^3
///   p(t) = p_i + b_1 a_1 + b_2 a_2 + b_3 a_3
///   U(t) = U_i exp(b_1 w_1) exp(b_2 w_2) exp(b_3 w_3)
///   S(t) = S_i + b_2 (S_i+1 - S_i)
/// where a pose's matrix is the rotation U times the symmetric stretch S. s is the length of the
/// piece in the parameter, u and v are the velocities at the poses, v in the model's frame:
///   a_1 = s u_i / 3, a_3 = s u_i+1 / 3, a_2 = p_i+1 - p_i - a_1 - a_3
///   w_1 = s v_i / 3, w_3 = s v_i+1 / 3, w_2 = log(exp(-w_1) U_i^-1 U_i+1 exp(-w_3))
/// Where two poses differ by a half turn, rounding decides which of the two senses is taken.
class PoseCurve {
 public:
  /// The pose at 0 <= t <= 1; at 0 and 1 the given poses, up to rounding.
  Pose at(double t) const;

 private:
  friend class PoseSpline;

  Eigen::Vector3d position_;
  Eigen::Quaterniond rotation_;
  Eigen::Matrix3d stretch_, stretch_change_;
  std::array<Eigen::Vector3d, 3> moves_;  ///< metres
  std::array<Eigen::Vector3d, 3> turns_;  ///< rotation vectors in the model's frame, radians
};

/// A curve through all poses of a trajectory with continuous velocity, in position and rotation.
/// Each way depends on two poses to either side of it. Stretching, which is what a pose has besides
/// a rotation, is interpolated by itself. Sources: M.-J. Kim, M.-S. Kim, S. Y. Shin, A general
/// construction scheme for unit quaternion curves, SIGGRAPH 1995 (rotation). E. T. Y. Lee, Choosing
/// nodes in parametric curve interpolation, Computer-Aided Design 21, 1989 (parametrisation).
/// C. de Boor, A practical guide to splines, 1978 (velocities, knots). F. N. Fritsch, R. E.
/// Carlson, Monotone piecewise cubic interpolation, SIAM J. Numer. Anal. 17, 1980 (limit of
/// velocities). K. Shoemake, T. Duff, Matrix animation and polar decomposition, Graphics Interface
/// 1992 (stretching).
class PoseSpline {
 public:
  /// poses: invertible; they must outlive the spline. motions: how far the model moves from each
  /// pose to the next, in metres, finite, one fewer than poses; 0 where it does not move.
  PoseSpline(std::span<const Pose> poses, std::span<const double> motions);

  /// The curve from pose i to pose i + 1. Throws InputError if one mirrors the model and the other
  /// does not.
  PoseCurve between(std::size_t i) const;
  /// The positions of `between(i)`, even if only one of the poses mirrors.
  PositionCurve positions(std::size_t i) const;

 private:
  /// Change per unit of the parameter.
  struct Velocity {
    Eigen::Vector3d linear, angular;  ///< angular: in the model's frame
  };
  /// An interval of the parameter between two different poses.
  struct Leg {
    std::size_t from;
    double span;
    Velocity mean;
  };

  Velocity at_knot(const std::vector<Leg>& legs, std::size_t knot) const;
  static Velocity weighted(const Velocity& a, double weight_a, const Velocity& b, double weight_b);
  static Velocity limited(const Velocity& velocity, const Velocity& before, const Velocity& after);

  std::span<const Pose> poses_;
  std::vector<double> spans_;         ///< lengths of the parameter's intervals between poses
  std::vector<Velocity> velocities_;  ///< one for each pose
};

}  // namespace clearway
