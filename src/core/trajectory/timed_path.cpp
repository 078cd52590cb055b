#include "core/trajectory/timed_path.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "clearway/error.hpp"
#include "core/util/format.hpp"

namespace clearway {
namespace {

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

void check_times(std::span<const Pose> poses, std::span<const double> times,
                 const std::string& name) {
  if (poses.empty() || times.size() != poses.size()) {
    throw InputError(name + ": its poses have no times; expected a time for each pose");
  }
  if (poses.size() < 2) throw InputError(name + ": has one pose; expected two at least");
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!std::isfinite(times[i])) {
      throw InputError(name + ": the time of pose " + std::to_string(i) +
                       " (counting from 0) is not finite; expected seconds");
    }
    if (i > 0 && times[i] <= times[i - 1]) {
      throw InputError(name + ": pose " + std::to_string(i) + " (counting from 0) has the time " +
                       format_number(times[i]) + " after " + format_number(times[i - 1]) +
                       "; expected times that ascend");
    }
  }
}

}  // namespace

TimedPath::TimedPath(std::span<const Pose> poses, std::vector<double> times, const Vec3& lever,
                     const std::string& name)
    : times_(std::move(times)), lever_(lever) {
  check_times(poses, times_, name);
  const bool turns = !(lever == Vec3{0, 0, 0});
  positions_.reserve(poses.size());
  if (turns) rotations_.reserve(poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    positions_.push_back(poses[i].position());
    if (i > 0 && times_[i] - times_[i - 1] > kLongestStep) {
      ++gaps_;
      longest_gap_ = std::max(longest_gap_, times_[i] - times_[i - 1]);
    }
    if (!turns) continue;
    const Eigen::Matrix3d matrix = Eigen::Map<const RowMajor>(poses[i].rotation);
    if (matrix.determinant() < 0) {
      throw InputError(name + ": pose " + std::to_string(i) +
                       " (counting from 0) mirrors; expected a rotation, because the lever arm "
                       "turns with it");
    }
    const Eigen::Quaterniond rotation = Eigen::Quaterniond(matrix).normalized();
    rotations_.push_back({rotation.x(), rotation.y(), rotation.z(), rotation.w()});
  }
}

TimedPath::Place TimedPath::at(double time, std::size_t& step) const {
  if (time < first()) return {Where::kBefore};
  if (time > last()) return {Where::kAfter};
  const auto holds = [&](std::size_t i) {
    return i + 1 < times_.size() && times_[i] <= time && time < times_[i + 1];
  };
  if (!holds(step)) {
    if (holds(step + 1)) {
      ++step;
    } else {
      const auto after = std::upper_bound(times_.begin(), times_.end(), time);
      step = static_cast<std::size_t>(after - times_.begin()) - 1;
    }
  }
  if (time == times_[step]) return {Where::kOnPath, between(step, 0)};
  const double seconds = times_[step + 1] - times_[step];
  if (seconds > kLongestStep) return {Where::kInGap};
  return {Where::kOnPath, between(step, (time - times_[step]) / seconds)};
}

Vec3 TimedPath::between(std::size_t step, double share) const {
  using Quaternion = Eigen::Map<const Eigen::Quaterniond>;  // x, y, z, w
  Vec3 position = positions_[step];
  if (share > 0) {
    const Vec3& end = positions_[step + 1];
    for (int k = 0; k < 3; ++k) position[k] += share * (end[k] - position[k]);
  }
  if (rotations_.empty()) return position;
  Eigen::Quaterniond rotation = Quaternion(rotations_[step].data());
  if (share > 0) rotation = rotation.slerp(share, Quaternion(rotations_[step + 1].data()));
  const Eigen::Vector3d arm = rotation * Eigen::Vector3d(lever_.x, lever_.y, lever_.z);
  for (int k = 0; k < 3; ++k) position[k] += arm[k];
  return position;
}

}  // namespace clearway
