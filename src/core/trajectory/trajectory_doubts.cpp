#include "core/trajectory/trajectory_doubts.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <utility>

#include "core/trajectory/trajectory_summary.hpp"

namespace clearway {
namespace {

using Matrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using Vector = Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

Message warning(const char* code, std::string text,
                std::vector<std::pair<std::string, double>> numbers) {
  return {Message::Severity::kWarning, code, std::move(text), std::move(numbers)};
}

/// How far the path turns: the largest angle between its first long chord and any other. A way
/// back on the same line is no turn.
double turn_of_path(std::span<const Pose> poses, double length) {
  constexpr double kPieces = 20;
  const auto chords = chords_of(poses, length / kPieces);
  double least = 1;
  for (const Chord& chord : chords) {
    const Vec3& a = chords[0].direction;
    const Vec3& b = chord.direction;
    least = std::min(least, std::abs(a.x * b.x + a.y * b.y + a.z * b.z));
  }
  return std::acos(std::min(1.0, least));
}

std::optional<Message> jump(const TrajectorySummary& summary, const std::string& name) {
  constexpr double kTimesMedian = 100;
  constexpr double kMetres = 10;
  if (!(summary.largest_step > std::max(kMetres, kTimesMedian * summary.median_step))) {
    return std::nullopt;
  }
  const auto from = summary.largest_step_pose;
  return warning("trajectory-jump",
                 name + ": from pose " + std::to_string(from) + " to " + std::to_string(from + 1) +
                     " are " + number(summary.largest_step) +
                     " m, while half of the steps are shorter than " + number(summary.median_step) +
                     " m",
                 {{"pose", static_cast<double>(from)},
                  {"step", summary.largest_step},
                  {"median_step", summary.median_step}});
}

std::optional<Message> missing_rotation(std::span<const Pose> poses, double path_turn,
                                        RotationSource source, const std::string& name) {
  constexpr double kPathTurn = 20 * kDegree;
  constexpr double kClearPathTurn = 60 * kDegree;
  constexpr double kRadiansAsDegrees = 6.4 * kDegree;  // half a turn to either side, misread
  constexpr double kNoTurn = 1e-9;
  const Pose identity{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {}};
  double from_identity = 0;
  double from_first = 0;
  for (const Pose& pose : poses) {
    from_identity = std::max(from_identity, turn_between(identity, pose));
    from_first = std::max(from_first, turn_between(poses[0], pose));
  }
  const std::string path =
      " although the path turns by " + number(path_turn / kDegree) + " degrees";
  const std::vector<std::pair<std::string, double>> numbers{
      {"path_turn_degrees", path_turn / kDegree}, {"turn_degrees", from_first / kDegree}};
  if (from_identity <= kNoTurn && path_turn > kPathTurn) {
    return warning("rotation-missing",
                   name + ": no pose turns the model," + path + "; rotations may be missing",
                   numbers);
  }
  if (source == RotationSource::kAngles && from_first < kRadiansAsDegrees &&
      path_turn > kClearPathTurn) {
    return warning("rotation-too-small",
                   name + ": the poses turn the model by " + number(from_first / kDegree) +
                       " degrees in all," + path + "; the angles may be radians",
                   numbers);
  }
  return std::nullopt;
}

/// How well the motion keeps one direction of the model, forwards or backwards: 1 where it always
/// does, 1/3 where it is all over. direction_of(chord): the motion in the model's frame.
template <typename DirectionOf>
double alignment(std::span<const Chord> chords, const DirectionOf& direction_of) {
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  double weight = 0;
  for (const Chord& chord : chords) {
    const Vector direction = direction_of(chord);
    moments += chord.length * direction * direction.transpose();
    weight += chord.length;
  }
  if (!(weight > 0)) return 1;
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moments / weight, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .maxCoeff();
}

Matrix rotation_of(const Pose& pose) { return Eigen::Map<const Matrix>(pose.rotation); }

/// The rotation of a quaternion that was read as x y z w but is w x y z, or the other way about.
Matrix reordered(const Pose& pose, bool w_came_first) {
  const Eigen::Quaterniond q(Eigen::Matrix3d(rotation_of(pose)));
  const Eigen::Quaterniond other = w_came_first ? Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w())
                                                : Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y());
  return other.normalized().toRotationMatrix();
}

/// The poses that map from the world to the model instead.
std::vector<Pose> inverse_of(std::span<const Pose> poses) {
  std::vector<Pose> inverse(poses.begin(), poses.end());
  for (Pose& pose : inverse) {
    const Matrix back = rotation_of(pose).transpose();
    const Vector position = -back * Eigen::Map<const Vector>(pose.translation);
    Eigen::Map<Matrix>(pose.rotation) = back;
    Eigen::Map<Vector>(pose.translation) = position;
  }
  return inverse;
}

double alignment_of(std::span<const Pose> poses, std::span<const Chord> chords) {
  return alignment(chords, [poses](const Chord& c) -> Vector {
    return rotation_of(poses[c.middle]).transpose() *
           Vector(c.direction.x, c.direction.y, c.direction.z);
  });
}

constexpr double kPieces = 500;
constexpr double kAligned = 0.97;
constexpr double kNotAligned = 0.8;

double alignment_of_inverse(std::span<const Pose> poses) {
  const auto inverse = inverse_of(poses);
  const double length = summarize_trajectory(inverse).length;
  return alignment_of(inverse, chords_of(inverse, length / kPieces));
}

/// A mistake after whose repair the motion would keep to one direction of the model.
std::optional<Message> other_rotation(std::span<const Pose> poses, double length,
                                      RotationSource source, const std::string& name) {
  const auto chords = chords_of(poses, length / kPieces);
  const double given = alignment_of(poses, chords);
  if (given > kNotAligned) return std::nullopt;
  const auto turned_by = [&](const auto& rotation) {
    return alignment(chords, [&](const Chord& c) -> Vector {
      return rotation(poses[c.middle]).transpose() *
             Vector(c.direction.x, c.direction.y, c.direction.z);
    });
  };
  const auto say = [&](const char* code, const char* what, double repaired) {
    return warning(code,
                   name + ": the model moves in changing directions of its own frame; " + what,
                   {{"alignment", given}, {"repaired_alignment", repaired}});
  };
  if (source == RotationSource::kQuaternions) {
    for (const bool first : {false, true}) {
      const double repaired = turned_by([first](const Pose& p) { return reordered(p, first); });
      if (repaired > kAligned) {
        return say("quaternion-order",
                   "with its quaternions in the order of w x y z instead of x y z w, "
                   "or the other way about, it would move straight ahead",
                   repaired);
      }
    }
  }
  if (const double repaired = alignment_of_inverse(poses); repaired > kAligned) {
    return say("poses-inverse",
               "with inverse poses it would move straight ahead. Poses map from the model to the "
               "environment",
               repaired);
  }
  const double repaired =
      turned_by([](const Pose& p) -> Matrix { return rotation_of(p).transpose(); });
  if (repaired > kAligned) {
    return say("turns-against-path",
               "it turns left where the path turns right. The columns x and y may be swapped, "
               "angles may be counted the other way, or matrices may be column by column",
               repaired);
  }
  return std::nullopt;
}

std::optional<Message> upside_down(const TrajectorySummary& summary, const std::string& name) {
  constexpr double kDown = 0.9;
  if (summary.up.axis != 2 || !summary.up.negative || summary.up.cosine < kDown) {
    return std::nullopt;
  }
  return warning("upside-down",
                 name +
                     ": the model's z axis points down; the order of quaternions, or the frame "
                     "of the model, may be another",
                 {{"cosine", -summary.up.cosine}});
}

}  // namespace

std::vector<Message> doubts_about(std::span<const Pose> poses, RotationSource source,
                                  const std::string& name) {
  std::vector<Message> doubts;
  const auto add = [&doubts](std::optional<Message> doubt) {
    if (doubt) doubts.push_back(std::move(*doubt));
    return doubts.size();
  };
  const TrajectorySummary summary = summarize_trajectory(poses);
  if (!std::isfinite(summary.length) || summary.length == 0) return doubts;
  add(jump(summary, name));
  const std::size_t before = doubts.size();
  const double path_turn = turn_of_path(poses, summary.length);
  constexpr double kTurnThatTells = 20 * kDegree;
  if (add(missing_rotation(poses, path_turn, source, name)) == before &&
      path_turn > kTurnThatTells) {
    add(other_rotation(poses, summary.length, source, name));
  }
  add(upside_down(summary, name));
  return doubts;
}

}  // namespace clearway
