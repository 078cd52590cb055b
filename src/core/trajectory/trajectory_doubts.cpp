#include "core/trajectory/trajectory_doubts.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "core/geometry/angle.hpp"
#include "core/messages/messages.hpp"
#include "core/trajectory/pose_ranges.hpp"
#include "core/trajectory/trajectory_summary.hpp"
#include "core/util/format.hpp"

namespace clearway {
namespace {

/// The median; for an even number of values, the mean of the two in the middle, so that at the
/// border between slow and fast neither of them alone says what is usual.
double median_of(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return (*std::max_element(values.begin(), middle) + *middle) / 2;
}

/// The poses from which the jumps start, such as "poses 100, 250", or the first few of many.
std::string starts_of(std::span<const Jump> jumps) {
  constexpr std::size_t kMost = 4;
  std::vector<std::size_t> poses;
  for (const Jump& jump : jumps) poses.push_back(jump.pose);
  const auto ranges = number_ranges(poses);
  std::string text = "poses ";
  for (std::size_t k = 0; k < std::min(ranges.size(), kMost); ++k) {
    text += (k > 0 ? ", " : "") + ranges[k];
  }
  return ranges.size() > kMost ? text + " and others" : text;
}

/// Number of poses in each row, if the jumps lead from row to row of a grid: they come after equal
/// numbers of poses and are equally long. 0 if they are not such jumps.
std::size_t row_of_grid(std::span<const Jump> jumps) {
  constexpr double kEqual = 0.01;
  if (jumps.size() < 2) return 0;
  const std::size_t row = jumps.front().pose + 1;
  for (std::size_t k = 0; k < jumps.size(); ++k) {
    if (jumps[k].pose + 1 != (k + 1) * row) return 0;
    const double length = jumps.front().length;
    if (std::abs(jumps[k].length - length) > kEqual * length) return 0;
  }
  return row;
}

}  // namespace

std::vector<double> step_lengths(std::span<const Pose> poses) {
  std::vector<double> steps;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const double* a = poses[i].translation;
    const double* b = poses[i + 1].translation;
    steps.push_back(std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]));
  }
  return steps;
}

std::vector<Jump> jumps_of(std::span<const double> steps, double least) {
  constexpr double kTimes = 5;
  constexpr std::size_t kEachSide = 5;
  std::vector<std::size_t> moving;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i] > 0) moving.push_back(i);
  }
  std::vector<Jump> jumps;
  std::vector<double> around;
  for (std::size_t k = 0; k < moving.size(); ++k) {
    const double step = steps[moving[k]];
    if (!(step > least)) continue;
    const std::size_t first = k - std::min(k, kEachSide);
    const std::size_t last = std::min(moving.size() - 1, k + kEachSide);
    around.clear();
    for (std::size_t j = first; j <= last; ++j) {
      if (j != k) around.push_back(steps[moving[j]]);
    }
    if (around.empty()) continue;
    const double usual = median_of(around);
    if (step > kTimes * usual) jumps.push_back({moving[k], step, usual});
  }
  return jumps;
}

Message jump_warning(std::span<const Jump> jumps, const std::string& prefix,
                     const std::string& unit, const std::string& consequence) {
  const Jump& worst = *std::ranges::max_element(jumps, {}, &Jump::length);
  const std::string where =
      "from pose " + std::to_string(worst.pose) + " to " + std::to_string(worst.pose + 1);
  const std::string begin = jumps.size() == 1
                                ? "the step " + where + " is "
                                : format_count(jumps.size()) +
                                      " steps are far longer than those around them, after " +
                                      starts_of(jumps) + ". The longest, " + where + ", is ";
  const std::size_t row = row_of_grid(jumps);
  const std::string cause = row > 0
                                ? "They come after every " + format_count(row) +
                                      " poses and are equally long, as between the rows of a grid"
                                : "Poses may be missing there, or one of them may be wrong";
  return warning_or_note(row == 0, "trajectory-jump",
                         prefix + begin + format_brief(worst.length) + " " + unit + " long, " +
                             format_brief(worst.length / worst.usual) +
                             " times the median of the steps around " + "it, which is " +
                             format_brief(worst.usual) + " " + unit + ". " + cause + consequence,
                         {{"jumps", static_cast<double>(jumps.size())},
                          {"pose", static_cast<double>(worst.pose)},
                          {"step", worst.length},
                          {"median_step", worst.usual}},
                         pose_ranges(jumps, 1, &Jump::pose));
}

double farthest_from_origin(std::span<const Vec3> points) {
  double squared = 0;
  for (const Vec3& p : points) squared = std::max(squared, p.x * p.x + p.y * p.y + p.z * p.z);
  return std::sqrt(squared);
}

std::vector<double> chord_deviations(std::span<const Pose> poses, double reach) {
  constexpr double kShareOfNeighbours = 0.2;
  const std::vector<double> steps = step_lengths(poses);
  std::vector<double> turns;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    turns.push_back(turn_between(poses[i], poses[i + 1]));
  }
  std::vector<double> deviations;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    double curvature = 0;
    const std::size_t last = std::min(i + 1, steps.size() - 1);
    for (std::size_t j = i - std::min<std::size_t>(i, 1); j <= last; ++j) {
      const bool counts = j == i || steps[j] >= kShareOfNeighbours * steps[i];
      if (counts && steps[i] > 0 && steps[j] > 0) {
        curvature = std::max(curvature, turns[j] / steps[j]);
      }
    }
    deviations.push_back(reach * (1 - std::cos(turns[i] / 2)) +
                         curvature * steps[i] * steps[i] / 8);
  }
  return deviations;
}

namespace {

using Matrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using Vector = Eigen::Vector3d;

/// Largest angle by which the path turns, in radians: that between its first long chord and any
/// other. Going back on the same line is not a turn.
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

std::optional<Message> missing_rotation(std::span<const Pose> poses, double path_turn,
                                        RotationSource source, const std::string& name) {
  constexpr double kPathTurn = 20 * kDegree;
  constexpr double kClearPathTurn = 30 * kDegree;
  // For a whole turn in radians that is read as degrees
  constexpr double kRadiansAsDegrees = 6.5 * kDegree;
  constexpr double kNoTurn = 1e-9;
  const Pose identity{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {}};
  double from_identity = 0;
  double from_first = 0;
  for (const Pose& pose : poses) {
    from_identity = std::max(from_identity, turn_between(identity, pose));
    from_first = std::max(from_first, turn_between(poses[0], pose));
  }
  const std::string path =
      " although the path turns by " + format_brief(path_turn / kDegree) + " degrees";
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
                   name + ": the poses turn the model by " + format_brief(from_first / kDegree) +
                       " degrees in all," + path + "; the angles may be radians",
                   numbers);
  }
  return std::nullopt;
}

/// How well the motion keeps to one direction of the model; 1 is perfect.
struct Alignment {
  double line = 1;  ///< alignment with a line, forwards or backwards; 1/3 for random directions
  double direction = 1;  ///< alignment with a direction, forwards only; 0 for random directions
  double ahead = 0;      ///< share of that direction along the model's x axis, of either sign

  /// Whether a mistake is almost certain, because repairing it makes order of disorder.
  bool repaired_by(const Alignment& other) const {
    constexpr double kOrder = 0.97;
    constexpr double kDisorder = 0.8;
    return (line < kDisorder && other.line > kOrder) ||
           (direction < kDisorder && other.direction > kOrder);
  }
};

/// The alignment of the motion along `chords`. rotation_at(pose): the rotation to judge.
template <typename RotationOf>
Alignment alignment(std::span<const Pose> poses, std::span<const Chord> chords,
                    const RotationOf& rotation_at) {
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  Vector sum = Vector::Zero();
  double weight = 0;
  for (const Chord& chord : chords) {
    const Vector way(chord.direction.x, chord.direction.y, chord.direction.z);
    const Vector direction = (rotation_at(poses[chord.middle]).transpose() * way).normalized();
    moments += chord.length * direction * direction.transpose();
    sum += chord.length * direction;
    weight += chord.length;
  }
  if (!(weight > 0)) return {};
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments / weight,
                                                              Eigen::EigenvaluesOnly);
  return {solver.eigenvalues().maxCoeff(), sum.norm() / weight,
          sum.norm() > 0 ? std::abs(sum.x()) / sum.norm() : 0};
}

Matrix rotation_of(const Pose& pose) { return Eigen::Map<const Matrix>(pose.rotation); }

std::vector<Chord> pieces_of(std::span<const Pose> poses, double length) {
  constexpr double kPieces = 500;
  return chords_of(poses, length / kPieces);
}

/// The poses inverted, as a file has them that maps from the world to the model.
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

/// Names the probable cause of a model that turns against its path. A path whose x and y are
/// swapped is the mirror image of the true one, as are headings that are counted clockwise from
/// north; with these rotations the model would move ahead on the swapped path. Rotations that are
/// transposed, or counted the other way, would move it ahead on the path as it is.
std::string cause_of_turns(std::span<const Pose> poses, double length, const Alignment& transposed,
                           RotationSource source) {
  constexpr double kAhead = 0.9;
  std::vector<Pose> swapped(poses.begin(), poses.end());
  for (Pose& pose : swapped) std::swap(pose.translation[0], pose.translation[1]);
  const Alignment of_swapped = alignment(swapped, pieces_of(swapped, length), rotation_of);
  const bool angles = source == RotationSource::kAngles;
  const std::string columns = "The columns x and y may be swapped";
  const std::string north =
      angles ? ", or headings may be counted clockwise from north" : ", as northing before easting";
  if (of_swapped.ahead > kAhead && of_swapped.ahead > transposed.ahead) return columns + north;
  const std::string other = angles ? "angles may be counted the other way"
                            : source == RotationSource::kMatrices
                                ? "matrices may be column by column"
                                : "quaternions may be of the inverse rotations";
  if (transposed.ahead > kAhead)
    return std::string(1, static_cast<char>(std::toupper(other[0]))) + other.substr(1);
  return columns + ", or " + other;
}

/// A warning of a mistake whose repair would make the motion keep to one direction of the model.
std::optional<Message> other_rotation(std::span<const Pose> poses, double length,
                                      RotationSource source, const std::string& name) {
  const auto chords = pieces_of(poses, length);
  const Alignment given = alignment(poses, chords, rotation_of);
  const std::string begin = name + ": the model moves in changing directions of its own frame; ";
  const auto numbers = [&given](const Alignment& repaired) {
    return std::vector<std::pair<std::string, double>>{{"alignment", given.direction},
                                                       {"repaired_alignment", repaired.direction}};
  };
  const auto inverse = inverse_of(poses);
  const double inverse_length = summarize_trajectory(inverse).length;
  const Alignment inverted = alignment(inverse, pieces_of(inverse, inverse_length), rotation_of);
  // Inverting swings positions about the world's origin: if the poses are right, the way gets
  // longer, and far from the origin it always keeps to one line.
  if (inverse_length < length && given.repaired_by(inverted)) {
    return warning("poses-inverse",
                   begin +
                       "with inverse poses it would move straight ahead. Poses map from the "
                       "model to the environment",
                   numbers(inverted));
  }
  const Alignment transposed = alignment(
      poses, chords, [](const Pose& pose) -> Matrix { return rotation_of(pose).transpose(); });
  if (given.repaired_by(transposed)) {
    return warning("turns-against-path",
                   begin + "it turns left where the path turns right. " +
                       cause_of_turns(poses, length, transposed, source),
                   numbers(transposed));
  }
  return std::nullopt;
}

/// The rotation of a quaternion that was read in the wrong order: as x y z w but is w x y z, or the
/// reverse.
Matrix reordered(const Pose& pose, bool w_came_first) {
  const Eigen::Quaterniond q(Eigen::Matrix3d(rotation_of(pose)));
  const Eigen::Quaterniond other = w_came_first ? Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w())
                                                : Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y());
  return other.normalized().toRotationMatrix();
}

template <typename RotationOf>
double worst_tilt(std::span<const Pose> poses, const RotationOf& rotation_at) {
  double least = 1;
  for (const Pose& pose : poses) least = std::min(least, rotation_at(pose)(2, 2));
  return std::acos(std::max(-1.0, least));
}

/// A warning if the quaternions seem to be in the other order. Vehicles stay nearly level, but with
/// a wrong order they tumble.
std::optional<Message> quaternion_order(std::span<const Pose> poses, const std::string& name) {
  constexpr double kTumbles = 15 * kDegree;
  constexpr double kTimesLess = 3;
  const double given = worst_tilt(poses, rotation_of);
  if (given < kTumbles) return std::nullopt;
  for (const bool w_came_first : {true, false}) {
    const double other = worst_tilt(
        poses, [w_came_first](const Pose& pose) { return reordered(pose, w_came_first); });
    if (kTimesLess * other > given) continue;
    return warning("quaternion-order",
                   name + ": the model tilts by up to " + format_brief(given / kDegree) +
                       " degrees, but by " + format_brief(other / kDegree) +
                       " with its quaternions as " + (w_came_first ? "w x y z" : "x y z w") +
                       "; their order may be another",
                   {{"tilt_degrees", given / kDegree}, {"other_tilt_degrees", other / kDegree}});
  }
  return std::nullopt;
}

/// What usually turns a model over, for each source of its rotations.
const char* cause_of_upside_down(RotationSource source) {
  switch (source) {
    case RotationSource::kQuaternions:
      return "the order of quaternions, or the frame of the model, may be another";
    case RotationSource::kAngles:
      return "angles may be of a frame whose z axis points down, or roll may be off by 180 degrees";
    case RotationSource::kMatrices:
      break;
  }
  return "matrices may be of a frame whose z axis points down, or the frame of the model may be "
         "another";
}

std::optional<Message> upside_down(const TrajectorySummary& summary, RotationSource source,
                                   const std::string& name) {
  constexpr double kDown = 0.9;
  if (summary.up.axis != 2 || !summary.up.negative || summary.up.cosine < kDown) {
    return std::nullopt;
  }
  return warning("upside-down",
                 name + ": the model's z axis points down; " + cause_of_upside_down(source),
                 {{"cosine", -summary.up.cosine}});
}

/// A warning of roll with the wrong sign. The path has to be level outside of its curves, because
/// on a slope a path may lean outwards wherever it turns uphill.
std::optional<Message> wrong_roll(std::span<const Pose> poses, const std::string& name) {
  constexpr double kMostLean = 0.015 / kUsualRails, kEnough = 0.2;
  const CurveLean lean = lean_in_curves(poses, kWrongCant / kUsualRails);
  if (!lean.is_mostly_outwards() || lean.elsewhere > kMostLean) return std::nullopt;
  if (lean.straight < kEnough * (lean.straight + lean.curved)) return std::nullopt;
  const double share = lean.outwards / lean.curved;
  return warning("cant-side",
                 name + ": on " + format_brief(100 * share) +
                     " % of the length of its curves the model leans outwards, by up to " +
                     format_brief(lean.greatest / kDegree) +
                     " degrees, and elsewhere it is level; roll or cant may have the wrong sign",
                 {{"share", share}, {"degrees", lean.greatest / kDegree}});
}

}  // namespace

CurveLean lean_in_curves(std::span<const Pose> poses, double least) {
  // Chords are long, so that noise of the positions bends the path less than a curve does.
  constexpr double kPieces = 50, kShortest = 1, kLongest = 10, kLeastCurvature = 1.0 / 2000;
  const double length = summarize_trajectory(poses).length;
  const auto chords = chords_of(poses, std::clamp(length / kPieces, kShortest, kLongest));
  // Positive to the left of the way.
  const auto lean_of = [&](const Chord& chord) {
    const double* r = poses[chord.middle].rotation;
    const Vec3& d = chord.direction;
    const double level = std::hypot(d.x, d.y);
    const double left = level > 0 ? (r[5] * d.x - r[2] * d.y) / level : 0;
    return std::asin(std::clamp(left, -1.0, 1.0));
  };
  CurveLean out;
  std::vector<double> elsewhere;
  for (std::size_t i = 1; i < chords.size(); ++i) {
    const Chord &a = chords[i - 1], &b = chords[i];
    const Vec3 &from = a.direction, &to = b.direction;
    const double turn = std::atan2(from.x * to.y - from.y * to.x, from.x * to.x + from.y * to.y);
    const double way = (a.length + b.length) / 2;
    const double lean = (lean_of(a) + lean_of(b)) / 2;
    if (std::abs(turn) < kLeastCurvature * way) {
      out.straight += way;
      elsewhere.push_back(std::abs(lean));
      continue;
    }
    const double outwards = turn > 0 ? -lean : lean;
    out.curved += way;
    if (outwards > least) out.outwards += way;
    out.greatest = std::max(out.greatest, outwards);
  }
  if (!elsewhere.empty()) out.elsewhere = median_of(elsewhere);
  return out;
}

std::vector<Message> doubts_about(std::span<const Pose> poses, RotationSource source,
                                  const std::string& name) {
  std::vector<Message> doubts;
  const auto add = [&doubts](std::optional<Message> doubt) {
    if (doubt) doubts.push_back(std::move(*doubt));
  };
  const TrajectorySummary summary = summarize_trajectory(poses);
  if (poses.empty() || !std::isfinite(summary.length)) return doubts;
  if (source == RotationSource::kQuaternions) add(quaternion_order(poses, name));
  if (doubts.empty()) add(upside_down(summary, source, name));
  if (summary.length == 0) return doubts;
  constexpr double kTurnThatTells = 20 * kDegree;
  const double path_turn = turn_of_path(poses, summary.length);
  if (doubts.empty()) add(missing_rotation(poses, path_turn, source, name));
  if (doubts.empty() && path_turn > kTurnThatTells) {
    add(other_rotation(poses, summary.length, source, name));
  }
  if (doubts.empty()) add(wrong_roll(poses, name));
  return doubts;
}

}  // namespace clearway
