#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "clearway/error.hpp"
#include "clearway/smooth.hpp"
#include "core/geometry/chord_pose.hpp"
#include "core/geometry/inside.hpp"
#include "core/geometry/rigid.hpp"
#include "core/trajectory/smooth/smooth_curve.hpp"
#include "core/trajectory/trajectory_doubts.hpp"
#include "core/trajectory/trajectory_summary.hpp"
#include "core/util/format.hpp"
#include "core/util/progress.hpp"

namespace clearway {
namespace {

/// The most spans that are tried for a path: more than any sensible distance needs, and so few that
/// it takes seconds to find out that a distance cannot be kept.
std::size_t most_spans(std::size_t poses) {
  constexpr std::size_t kFew = 1 << 16, kMany = 1 << 20, kOfPose = 8;
  return std::clamp(kOfPose * poses, kFew, kMany);
}

constexpr std::uint64_t kMostPoses = 10'000'000;
/// The share of the distance that the curve may take. The rest is for the chords of the new path.
constexpr double kCurveShare = 31.0 / 32;
/// How far the columns of a rotation may be from orthonormal ones.
constexpr double kMostSkew = 1e-3;

bool same_rotation(const Pose& a, const Pose& b) {
  return std::equal(a.rotation, a.rotation + 9, b.rotation);
}

/// The map on the way from a to b; a itself, bit for bit, where the way begins.
Pose on_chord(const Pose& a, const Pose& b, double part) {
  return part == 0 ? a : pose_on_chords(a, b, part);
}

void check_is_rotation(const Pose& pose, std::size_t index) {
  const auto column = [&](int k) {
    return Vec3{pose.rotation[k], pose.rotation[k + 3], pose.rotation[k + 6]};
  };
  double skew = 0;
  for (int a = 0; a < 3; ++a) {
    for (int b = a; b < 3; ++b) {
      skew = std::max(skew, std::abs(dot(column(a), column(b)) - (a == b ? 1 : 0)));
    }
  }
  if (skew <= kMostSkew && PullBack(pose).determinant > 0) return;
  throw InputError("pose " + std::to_string(index) +
                   " (counting from 0) scales, shears or mirrors; only rotations can be smoothed");
}

/// The path with the motion of the model as its parameter.
ParameterisedPath parameterised(std::span<const Pose> poses, const std::vector<double>& motions,
                                bool turns) {
  ParameterisedPath path;
  double at = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    path.at.push_back(at);
    if (i < motions.size()) at += motions[i];
    path.positions.emplace_back(Eigen::Map<const Eigen::Vector3d>(poses[i].translation));
    if (!turns) continue;
    check_is_rotation(poses[i], i);
    const Eigen::Matrix3d matrix =
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(poses[i].rotation);
    Eigen::Quaterniond rotation = Eigen::Quaterniond(matrix).normalized();
    if (!path.rotations.empty() && rotation.dot(path.rotations.back()) < 0) {
      rotation.coeffs() = -rotation.coeffs();
    }
    path.rotations.push_back(rotation);
  }
  return path;
}

/// One smoothing of a path.
class Smoothing {
 public:
  Smoothing(std::span<const Pose> poses, const SmoothParameters& parameters,
            const std::optional<Box>& model, Progress& progress)
      : poses_(poses),
        parameters_(parameters),
        model_(model.value_or(Box{{0, 0, 0}, {0, 0, 0}})),
        progress_(progress) {
    if (parameters_.step == 0) parameters_.step = 0.1;
    check(model.has_value());
    path_ = parameterised(poses, motions_, turns_);
    for (unsigned i = 0; i < 8; ++i) {
      reach_ = std::max(reach_, length(model_.corner(i)) * (1 + 1e-12));
    }
    double largest = reach_;
    for (const Pose& pose : poses) {
      for (const double value : pose.translation) largest = std::max(largest, std::abs(value));
    }
    rounding_ = 16 * std::numeric_limits<double>::epsilon() * largest;
  }

  SmoothPath run() {
    progress_.begin("smooth", 0, "curves");
    const SmoothCurve curve = least_curve();
    SmoothPath path;
    double step = parameters_.step;
    for (int tries = 0; tries < 12; ++tries, step /= 2) {
      path = written(curve, step);
      measure(path);
      if (path.largest_deviation <= parameters_.within) {
        progress_.end();
        return path;
      }
    }
    refuse_within();
  }

 private:
  void check(bool has_model) {
    for (const double length : {parameters_.within, parameters_.step}) {
      if (std::isfinite(length) && length > 0) continue;
      throw UsageError("a length of " + format_number(length) + "; expected one above 0");
    }
    if (poses_.empty()) throw InputError("has no poses; expected a path");
    turns_ = !std::ranges::all_of(
        poses_, [&](const Pose& pose) { return same_rotation(pose, poses_.front()); });
    if (turns_ && !has_model) {
      throw UsageError(
          "rotations change along the path, and how far they move a vehicle depends on its size; "
          "expected the model");
    }
    if (!turns_) check_is_rotation(poses_.front(), 0);
    for (std::size_t i = 0; i + 1 < poses_.size(); ++i) {
      motions_.push_back(motion_bound(model_, poses_[i], poses_[i + 1]));
      if (std::isfinite(motions_.back())) continue;
      throw InputError("the motion from pose " + std::to_string(i) +
                       " (counting from 0) to the next is no finite number");
    }
    const std::vector<Jump> jumps = jumps_of(motions_, kLeastJump);
    if (jumps.empty()) return;
    const Jump& first = jumps.front();
    throw InputError("jumps by " + format_brief(first.length) + " from pose " +
                     std::to_string(first.pose) + " to pose " + std::to_string(first.pose + 1) +
                     " (counting from 0), where steps are of " + format_brief(first.usual) +
                     ", so nobody knows the way between them. Divide the path there, or have the "
                     "gap filled");
  }

  [[noreturn]] void refuse_within() const {
    throw UsageError("no curve of " + format_count(most_spans(poses_.size())) +
                     " control points stays within " + format_number(parameters_.within) +
                     " of the path; expected a greater distance");
  }

  SmoothCurve curve_of(std::size_t spans) const {
    throw_if_stopped(progress_);
    progress_.advance(1);
    return {path_, spans, std::span<const double, 9>(poses_.front().rotation)};
  }

  /// The curve with the fewest spans that doubling and bisecting finds.
  SmoothCurve least_curve() const {
    std::size_t fails = 0, fits = 1;
    SmoothCurve best = curve_of(fits);
    while (!is_within(best)) {
      if (fits >= most_spans(poses_.size())) refuse_within();
      fails = fits;
      fits *= 2;
      best = curve_of(fits);
    }
    while (fits - fails > 1 + fits / 256) {
      const std::size_t middle = fails + (fits - fails) / 2;
      SmoothCurve curve = curve_of(middle);
      if (is_within(curve)) {
        fits = middle;
        best = std::move(curve);
      } else {
        fails = middle;
      }
    }
    return best;
  }

  double distance(const Pose& a, const Pose& b) const {
    return displacement_bound(model_, a, b) + rounding_;
  }

  /// Whether the curve is near enough to the path everywhere.
  bool is_within(const SmoothCurve& curve) const {
    const double limit = parameters_.within * kCurveShare;
    if (!(distance(poses_[0], curve.at(0)) <= limit)) return false;
    std::size_t span = 0;  // up to whose end the path was looked at
    for (std::size_t i = 0; i + 1 < poses_.size(); ++i) {
      const double from = path_.at[i], to = path_.at[i + 1];
      if (!(to > from)) {
        if (!(distance(poses_[i + 1], curve.at(to)) <= limit)) return false;
        continue;
      }
      double at = from;
      while (at < to) {
        double next = to;
        // The next knot after this place.
        while (span + 1 < curve.spans() && static_cast<double>(span + 1) * curve.spacing() <= at) {
          ++span;
        }
        const double knot = static_cast<double>(span + 1) * curve.spacing();
        if (span + 1 < curve.spans()) next = std::min(next, knot);
        if (!piece_is_within(curve, i, at, next, limit, 0)) return false;
        at = next;
      }
    }
    return true;
  }

  /// Whether the curve is near enough to the chord from pose i between two places with no knot in
  /// between. The difference of curve and chord has the curve's second derivative, so between the
  /// ends it is at most by the square of the way times an eighth of that longer than there.
  bool piece_is_within(const SmoothCurve& curve, std::size_t i, double from, double to,
                       double limit, int depth) const {
    const double way = path_.at[i + 1] - path_.at[i];
    const auto deviation = [&](double at) {
      const double part = std::clamp((at - path_.at[i]) / way, 0.0, 1.0);
      return distance(on_chord(poses_[i], poses_[i + 1], part), curve.at(at));
    };
    const double ends = std::max(deviation(from), deviation(to));
    if (!(ends <= limit)) return false;
    const double length = to - from;
    const double bulge = length * length / 8 * curve.second_derivative_bound(from, to, reach_);
    if (ends + bulge <= limit) return true;
    const double middle = from + length / 2;
    return depth < 24 && middle > from && middle < to &&
           piece_is_within(curve, i, from, middle, limit, depth + 1) &&
           piece_is_within(curve, i, middle, to, limit, depth + 1);
  }

  /// Poses on the curve from each of which no model point moves farther than `step` to the next.
  SmoothPath written(const SmoothCurve& curve, double step) const {
    SmoothPath out;
    out.control_points = curve.control_points();
    std::vector<double> at{0};
    out.poses.push_back(curve.at(0));
    const double length = path_.length(), most = 2 * curve.spacing();
    double way = std::min(step, most);
    while (at.back() < length) {
      throw_if_stopped(progress_);
      double next = std::min(at.back() + way, length);
      if (!(next > at.back())) refuse_step();
      const Pose pose = curve.at(next);
      const double motion = motion_bound(model_, out.poses.back(), pose);
      if (!(motion <= step)) {
        way = (next - at.back()) * std::clamp(0.98 * step / motion, 0.1, 0.98);
        continue;
      }
      at.push_back(next);
      out.poses.push_back(pose);
      if (out.poses.size() > kMostPoses) refuse_step();
      way = std::min(most, way * (motion > 0 ? std::clamp(0.99 * step / motion, 0.5, 4.0) : 4));
    }
    out.place = places_of(at);
    return out;
  }

  [[noreturn]] void refuse_step() const {
    throw UsageError("a step of " + format_number(parameters_.step) +
                     " takes more than ten million poses, or rounding alone moves the model by as "
                     "much; expected a greater one");
  }

  std::vector<double> places_of(const std::vector<double>& at) const {
    std::vector<double> out;
    std::size_t i = 0;
    for (const double place : at) {
      while (i + 1 < path_.at.size() && path_.at[i + 1] <= place) ++i;
      const double way = i + 1 < path_.at.size() ? path_.at[i + 1] - path_.at[i] : 0;
      out.push_back(static_cast<double>(i) +
                    (way > 0 ? std::clamp((place - path_.at[i]) / way, 0.0, 1.0) : 0));
    }
    return out;
  }

  /// The path at a place, as SmoothPath::place has it.
  Pose given_at(double place) const {
    const auto i = std::min(static_cast<std::size_t>(place), poses_.size() - 1);
    const double part = place - static_cast<double>(i);
    return part > 0 ? on_chord(poses_[i], poses_[i + 1], part) : poses_[i];
  }

  /// Compares the new path with the given one. Between two places that are a pose of neither,
  /// both move a model point along chords, so their distance is greatest at such a place.
  void measure(SmoothPath& path) const {
    double largest = 0, sum = 0;
    std::size_t k = 0;  // of the new poses: the last one at or before the given pose
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      const auto place = static_cast<double>(i);
      while (k + 1 < path.poses.size() && path.place[k + 1] <= place) ++k;
      Pose there = path.poses[k];
      if (k + 1 < path.poses.size() && path.place[k] < place) {
        const double from = parameter_of(path.place[k]), to = parameter_of(path.place[k + 1]);
        if (to > from) {
          const double part = std::clamp((path_.at[i] - from) / (to - from), 0.0, 1.0);
          there = on_chord(path.poses[k], path.poses[k + 1], part);
        }
      }
      const double here = distance(poses_[i], there);
      largest = std::max(largest, here);
      sum += here;
    }
    for (std::size_t j = 0; j < path.poses.size(); ++j) {
      largest = std::max(largest, distance(given_at(path.place[j]), path.poses[j]));
    }
    path.largest_deviation = largest;
    path.mean_deviation = std::min(sum / static_cast<double>(poses_.size()), largest);
    path.largest_step = largest_motion(model_, path.poses);
  }

  double parameter_of(double place) const {
    const auto i = std::min(static_cast<std::size_t>(place), poses_.size() - 1);
    const double part = place - static_cast<double>(i);
    return part > 0 ? path_.at[i] + part * (path_.at[i + 1] - path_.at[i]) : path_.at[i];
  }

  std::span<const Pose> poses_;
  SmoothParameters parameters_;
  Box model_;
  Progress& progress_;
  std::vector<double> motions_;
  ParameterisedPath path_;
  bool turns_ = false;
  double reach_ = 0;     ///< greatest distance of a model point from its origin
  double rounding_ = 0;  ///< more than the rounding of poses on chords
};

}  // namespace

SmoothPath smooth_trajectory(std::span<const Pose> poses, const SmoothParameters& parameters,
                             const std::optional<Box>& model, const ProgressCallback& callback,
                             StopFlag stop) {
  CallbackProgress progress(callback, stop);
  return Smoothing(poses, parameters, model, progress).run();
}

}  // namespace clearway
