#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/progress.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// The least jump that is reported if no radius is known, in metres.
inline constexpr double kLeastJump = 0.1;

/// A step that is far longer than those around it: poses are missing there, or one of them is
/// wrong.
struct Jump {
  std::size_t pose = 0;  ///< pose from which the step starts
  double length = 0;
  double usual = 0;  ///< median of the steps around it
};

/// The distances of consecutive positions; one fewer than poses.
std::vector<double> step_lengths(std::span<const Pose> poses);

/// The steps that are longer than `least` and more than five times as long as the median of the ten
/// steps around them: five before and five after, or fewer at the ends. Steps of length 0 are
/// skipped, because a model that stands still says nothing of how long its steps are.
std::vector<Jump> jumps_of(std::span<const double> steps, double least);

/// The single warning "trajectory-jump" for all jumps, or a note if the poses are rows of a grid.
/// jumps: not empty, with poses as users count them. The text begins with `prefix`, for example
/// "path.txt: ", and ends with `consequence`, which is a sentence such as ". Nothing is searched
/// there", or empty. unit: unit of the lengths, "m" or "ft".
Message jump_warning(std::span<const Jump> jumps, const std::string& prefix,
                     const std::string& unit, const std::string& consequence);

/// The greatest distance of a point from the origin; 0 for no points.
double farthest_from_origin(std::span<const Vec3> points);

/// Bound, for each step, of the distance between the true motion of a model point and the straight
/// way between two poses: L (1 - cos(turn / 2)) + kappa step^2 / 8, where L is `reach`, the
/// greatest distance of the model from its origin. kappa is the greatest turn / step of this step
/// and of those of its two neighbours that are at least a fifth as long; for a step of length 0 it
/// is 0. docs/design/numerics.md, "Between poses".
std::vector<double> chord_deviations(std::span<const Pose> poses, double reach);

/// How the poses lean where the path curves and where it does not.
struct CurveLean {
  double curved = 0;    ///< length of the path in curves of less than 2 km radius, metres
  double outwards = 0;  ///< the part of it that leans outwards by more than what was asked
  double greatest = 0;  ///< the greatest angle by which a curve leans outwards, radians
  double straight = 0;  ///< length of the rest of the path, metres
  /// The median of the angles by which the rest leans to either side, radians; 0 where there is
  /// none.
  double elsewhere = 0;

  bool is_mostly_outwards() const { return outwards > curved / 2; }
};

/// The lean of the poses, of whatever is above `least` radians. Cant and the camber of roads lean
/// inwards, or hardly at all. The poses' z axis points up.
CurveLean lean_in_curves(std::span<const Pose> poses, double least);

/// The least cant in metres, on rails whose middles are `kUsualRails` apart, that counts as one to
/// the wrong side.
inline constexpr double kWrongCant = 0.05;
/// Distance between the middles of the rails of standard gauge, metres.
inline constexpr double kUsualRails = 1.5;

/// The form in which a file held rotations.
enum class RotationSource { kMatrices, kQuaternions, kAngles };

/// Warnings of poses that are hardly meant so: rotations that are missing, in another unit or turn
/// against the path; inverse poses; quaternions in another order; roll with the wrong sign. Silent
/// if the path does not turn enough to show it. Steps between poses are judged by the functions
/// above, once the radius is known. name: the file's name for the messages.
/// docs/design/trajectory.md, "Doubts".
std::vector<Message> doubts_about(std::span<const Pose> poses, RotationSource source,
                                  const std::string& name);

}  // namespace clearway
