#include "core/sweep/profile/profile_travel.hpp"

#include <cmath>

#include "core/geometry/rigid.hpp"

namespace clearway {
namespace {

/// Replaces every value by the sum up to it, rounded up, so that the difference of two sums is at
/// least the exact sum of the values between. A value that is not a number becomes infinity.
void sum_up(std::vector<double>& values) {
  double sum = 0;
  for (double& value : values) {
    if (value != 0) {
      sum = value >= 0 ? std::nextafter(sum + value, kInfinity) : kInfinity;
    }
    value = sum;
  }
}

}  // namespace

ProfileTravel::ProfileTravel(const MotionTreeRef& motion, const Box& model, bool has_floor,
                             int threads)
    : moved_(motion.pose_count) {
  if (has_floor) {
    turned_.resize(moved_.size());
    risen_.resize(moved_.size());
  }
#pragma omp parallel for schedule(static) num_threads(threads)
  for (std::size_t i = 1; i < moved_.size(); ++i) {
    if (motion.poses[i] == motion.poses[i - 1]) continue;
    moved_[i] = displacement_bound(model, motion.poses[i - 1], motion.poses[i]);
    if (!has_floor) continue;
    const InversePose& before = motion.inverse_poses[i - 1];
    const InversePose& here = motion.inverse_poses[i];
    double squared = 0, height = 0, terms = 0;
    for (int k = 0; k < 3; ++k) {
      const double turned = here.inverse[6 + k] - before.inverse[6 + k];
      squared += turned * turned;
      const double term = here.inverse[6 + k] * (before.translation[k] - here.translation[k]);
      height += term;
      terms += std::abs(term);
    }
    turned_[i] = std::sqrt(squared) * kRoundedUp;
    risen_[i] = std::abs(height) + 8 * kUnitRoundoff * terms;
  }
  sum_up(moved_);
  sum_up(turned_);
  sum_up(risen_);
}

std::uint32_t ProfileTravel::sleep(std::uint32_t pose, std::uint32_t end, double farthest,
                                   double gap) const {
  const double from = height_change(pose, farthest) / kRoundedUp;
  std::uint32_t first = pose + 1;
  while (first < end) {
    const std::uint32_t middle = first + (end - first) / 2;
    // A change that is not a number may be of any size.
    if (height_change(middle, farthest) * kRoundedUp < from + gap) {
      first = middle + 1;
    } else {
      end = middle;
    }
  }
  return first;
}

}  // namespace clearway
