#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// The way of a point that is fixed to a moving frame, by the time: between two poses the position
/// of the frame moves on a straight line and its rotation by slerp, both evenly in time. Nothing is
/// known before the first pose, after the last one, and between two poses that are more than
/// kLongestStep apart.
class TimedPath {
 public:
  static constexpr double kLongestStep = 1;  ///< seconds

  enum class Where { kOnPath, kBefore, kAfter, kInGap };
  struct Place {
    Where where;
    Vec3 position{};  ///< only where it is on the path
  };

  /// times: seconds, one for each pose, two at least. lever: position of the point in the frame of
  /// the poses. Throws InputError, which begins with `name`, unless the times are finite and
  /// ascend, and where a pose mirrors and the point is not the frame's origin.
  TimedPath(std::span<const Pose> poses, std::vector<double> times, const Vec3& lever,
            const std::string& name);

  double first() const { return times_.front(); }
  double last() const { return times_.back(); }
  /// The place of the point at a time, which is not NaN. step: the step on which the last time was
  /// found, 0 at first; it makes the search fast for times that ascend.
  Place at(double time, std::size_t& step) const;
  /// Number of pairs of poses that are more than kLongestStep apart, and the greatest such time.
  std::uint64_t gaps() const { return gaps_; }
  double longest_gap() const { return longest_gap_; }

  std::uint64_t bytes() const {
    return times_.capacity() * sizeof(double) + positions_.capacity() * sizeof(Vec3) +
           rotations_.capacity() * sizeof(Rotation);
  }

 private:
  using Rotation = std::array<double, 4>;  ///< a unit quaternion x, y, z, w

  Vec3 between(std::size_t step, double share) const;

  std::vector<double> times_;
  std::vector<Vec3> positions_;
  std::vector<Rotation> rotations_;  ///< empty where the lever is 0
  Vec3 lever_;
  std::uint64_t gaps_ = 0;
  double longest_gap_ = 0;
};

}  // namespace clearway
