#include "core/trajectory/smooth/smooth_curve.hpp"

#include <Eigen/Sparse>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "clearway/error.hpp"
#include "core/trajectory/eigen_pose.hpp"

namespace clearway {
namespace {

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using Columns = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic>;

/// The four B-splines that are not 0 within a span.
std::array<double, 4> basis(double t) {
  const double rest = 1 - t;
  return {rest * rest * rest / 6, ((3 * t - 6) * t * t + 4) / 6,
          (((-3 * t + 3) * t + 3) * t + 1) / 6, t * t * t / 6};
}

/// A place of the path that the curve is fitted to.
struct Sample {
  double at, weight;
  std::size_t pose;  ///< the pose before it
  double part;       ///< of the way to the next pose
};

/// Samples of the path and its chords, at most a quarter of `spacing` apart, so that every span has
/// enough of them. Their weights are those of the trapezoidal rule.
std::vector<Sample> samples_of(const ParameterisedPath& path, double spacing) {
  std::vector<Sample> samples{{0, 0, 0, 0}};
  for (std::size_t i = 0; i + 1 < path.at.size(); ++i) {
    const double way = path.at[i + 1] - path.at[i];
    if (!(way > 0)) continue;
    const auto parts = static_cast<std::size_t>(std::max(1.0, std::ceil(4 * way / spacing)));
    const double half = way / static_cast<double>(parts) / spacing / 2;
    for (std::size_t k = 1; k <= parts; ++k) {
      samples.back().weight += half;
      const double part = static_cast<double>(k) / static_cast<double>(parts);
      samples.push_back({path.at[i] + part * way, half, i, part});
    }
  }
  return samples;
}

/// The normal equations of a least-squares fit of B-splines: a band of seven diagonals.
class NormalEquations {
 public:
  /// place_of(parameter): the span and the place within it.
  template <typename PlaceOf>
  NormalEquations(std::span<const Sample> samples, std::size_t controls, const PlaceOf& place_of)
      : controls_(controls), samples_(samples) {
    std::vector<std::array<double, 4>> band(controls);  // of column j: rows j to j + 3
    places_.reserve(samples.size());
    for (const Sample& sample : samples) {
      const auto [span, t] = place_of(sample.at);
      const std::array<double, 4> b = basis(t);
      for (std::size_t c = 0; c < 4; ++c) {
        for (std::size_t r = c; r < 4; ++r) band[span + c][r - c] += sample.weight * b[c] * b[r];
      }
      places_.push_back({span, b});
    }
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(4 * controls);
    for (std::size_t c = 0; c < controls; ++c) {
      for (std::size_t r = c; r < std::min(c + 4, controls); ++r) {
        entries.emplace_back(static_cast<int>(r), static_cast<int>(c), band[c][r - c]);
      }
    }
    const auto n = static_cast<Eigen::Index>(controls);
    Eigen::SparseMatrix<double> matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    factor_.compute(matrix);
    if (factor_.info() != Eigen::Success) {
      throw InputError(
          "the positions of the path are no finite numbers that a curve can be put to");
    }
  }

  /// The control values for these values of the samples: a row for each.
  template <typename ValueOf>
  Columns solve(Eigen::Index dimensions, const ValueOf& value_of) const {
    Columns right = Columns::Zero(static_cast<Eigen::Index>(controls_), dimensions);
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const auto value = value_of(i);
      const auto& [span, b] = places_[i];
      for (std::size_t k = 0; k < 4; ++k) {
        const auto row = static_cast<Eigen::Index>(span + k);
        for (Eigen::Index d = 0; d < dimensions; ++d) {
          right(row, d) += samples_[i].weight * b[k] * value[d];
        }
      }
    }
    return factor_.solve(right);
  }

 private:
  std::size_t controls_;
  std::span<const Sample> samples_;
  std::vector<std::pair<std::size_t, std::array<double, 4>>> places_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>>
      factor_;
};

Eigen::Quaterniond unit(const Eigen::Vector4d& q) {
  const double length = q.norm();
  return length > 1e-6 ? Eigen::Quaterniond(Eigen::Vector4d(q / length))
                       : Eigen::Quaterniond::Identity();
}

/// More than places within a span are rounded by, relative to the span.
constexpr double kRounding = 1e-9;

/// Corrections of the control rotations end where they are this small, in radians, or after so many
/// steps: a curve that is still not close then has too few control points.
constexpr double kSmallTurn = 1e-9;
constexpr int kMostCorrections = 4;

}  // namespace

SmoothCurve::SmoothCurve(const ParameterisedPath& path, std::size_t spans,
                         std::span<const double, 9> fixed)
    : spacing_(path.length() > 0 ? path.length() / static_cast<double>(spans) : 1),
      origin_(path.positions.front()),
      control_(spans + 3, Eigen::Vector3d::Zero()) {
  std::ranges::copy(fixed, fixed_);
  if (path.length() > 0) {
    fit(path);
  } else if (!path.rotations.empty()) {
    rotation_.assign(control_.size(), path.rotations.front());
    find_turns();
  }
}

SmoothCurve::Place SmoothCurve::place_of(double parameter) const {
  const double at = std::max(parameter / spacing_, 0.0);
  const auto span = std::min(static_cast<std::size_t>(at), spans() - 1);
  return {span, std::min(at - static_cast<double>(span), 1.0)};
}

void SmoothCurve::fit(const ParameterisedPath& path) {
  const std::vector<Sample> samples = samples_of(path, spacing_);
  const NormalEquations equations(samples, control_.size(), [this](double parameter) {
    const Place place = place_of(parameter);
    return std::pair(place.span, place.t);
  });
  const Columns positions = equations.solve(3, [&](std::size_t i) -> Eigen::Vector3d {
    const auto& [at, weight, pose, part] = samples[i];
    const Eigen::Vector3d from = path.positions[pose] - origin_;
    if (part == 0) return from;
    return from + part * (path.positions[pose + 1] - path.positions[pose]);
  });
  for (std::size_t k = 0; k < control_.size(); ++k) {
    control_[k] = positions.row(static_cast<Eigen::Index>(k)).transpose();
  }
  if (path.rotations.empty()) return;
  const auto rotation_of = [&](std::size_t i) -> Eigen::Vector4d {
    const auto& [at, weight, pose, part] = samples[i];
    const Eigen::Vector4d from = path.rotations[pose].coeffs();
    if (part == 0) return from;
    return (from + part * (path.rotations[pose + 1].coeffs() - from)).normalized();
  };
  const Columns quaternions = equations.solve(4, rotation_of);
  for (std::size_t k = 0; k < control_.size(); ++k) {
    rotation_.push_back(unit(quaternions.row(static_cast<Eigen::Index>(k)).transpose()));
  }
  for (int step = 0; step < kMostCorrections; ++step) {
    find_turns();
    const Columns changes = equations.solve(3, [&](std::size_t i) -> Eigen::Vector3d {
      return logarithm(rotation_at(place_of(samples[i].at)).conjugate() *
                       Eigen::Quaterniond(rotation_of(i)));
    });
    for (std::size_t k = 0; k < rotation_.size(); ++k) {
      const Eigen::Vector3d change = changes.row(static_cast<Eigen::Index>(k)).transpose();
      rotation_[k] = (rotation_[k] * exponential(change)).normalized();
    }
    if (!(changes.rowwise().norm().maxCoeff() > kSmallTurn)) break;
  }
  find_turns();
}

void SmoothCurve::find_turns() {
  turn_.assign(rotation_.size(), Eigen::Vector3d::Zero());
  for (std::size_t k = 1; k < rotation_.size(); ++k) {
    turn_[k] = logarithm(rotation_[k - 1].conjugate() * rotation_[k]);
  }
}

Eigen::Quaterniond SmoothCurve::rotation_at(const Place& place) const {
  const std::array<double, 4> b = basis(place.t);
  const std::size_t k = place.span;
  return rotation_[k] * exponential((1 - b[0]) * turn_[k + 1]) *
         exponential((b[2] + b[3]) * turn_[k + 2]) * exponential(b[3] * turn_[k + 3]);
}

Pose SmoothCurve::at(double parameter) const {
  const Place place = place_of(parameter);
  const std::array<double, 4> b = basis(place.t);
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < 4; ++k) position += b[k] * control_[place.span + k];
  position += origin_;
  Pose pose{};
  std::copy(position.data(), position.data() + 3, pose.translation);
  if (rotation_.empty()) {
    std::copy(fixed_, fixed_ + 9, pose.rotation);
  } else {
    const RowMajor matrix = rotation_at(place).normalized().toRotationMatrix();
    std::copy(matrix.data(), matrix.data() + 9, pose.rotation);
  }
  return pose;
}

/// For positions the second derivative is linear in a span. For a model point at the distance r
/// from the origin the rotation adds at most r (3/2 s^2 + a), where s is the sum of c_k' |w_k| and
/// a that of |c_k''| |w_k|, each at its greatest on the part: R'' = R ([w]^2 + [w']) with the
/// angular velocity w, |w| <= s and |w'| <= a + s^2 / 2. c_k are the cumulative B-splines of a span
/// and w_k the turns between its control rotations.
double SmoothCurve::second_derivative_bound(double from, double to, double reach) const {
  const auto [span, middle] = place_of((from + to) / 2);
  const auto within = [this, k = span](double parameter) {
    return std::clamp(parameter / spacing_ - static_cast<double>(k), 0.0, 1.0);
  };
  const double first = within(from), last = within(to);
  const auto second_derivative = [this, k = span](double t) {
    return ((1 - t) * control_[k] + (3 * t - 2) * control_[k + 1] + (1 - 3 * t) * control_[k + 2] +
            t * control_[k + 3])
        .norm();
  };
  // That of a cubic is linear, so its ends bound it. The second term is for their rounding.
  const double linear = std::max(second_derivative(first), second_derivative(last)) +
                        kRounding * (second_derivative(0) + second_derivative(1));
  double turning = 0;
  if (!rotation_.empty()) {
    // Greatest first and second derivatives of the three cumulative B-splines over [first, last].
    const double top = std::clamp(0.5, first, last);
    const double one[] = {(1 - first) * (1 - first) / 2, 0.5 + top - top * top, last * last / 2};
    const double two[] = {1 - first, std::max(std::abs(1 - 2 * first), std::abs(1 - 2 * last)),
                          last};
    double speed = 0, change = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double turn = turn_[span + k + 1].norm();
      speed += (one[k] + kRounding) * turn;
      change += (two[k] + kRounding) * turn;
    }
    turning = reach * (1.5 * speed * speed + change);
  }
  return (linear + turning) / (spacing_ * spacing_) * (1 + kRounding);
}

}  // namespace clearway
