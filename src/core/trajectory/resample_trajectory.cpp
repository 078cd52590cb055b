#include "core/trajectory/resample_trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "clearway/error.hpp"
#include "core/trajectory/pose_spline.hpp"
#include "core/trajectory/trajectory_summary.hpp"
#include "core/util/format.hpp"

namespace clearway {

std::vector<std::size_t> thin_trajectory(std::span<const Pose> poses, const Box& model,
                                         double max_motion) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const bool stood_for =
        !kept.empty() && motion_bound(model, poses[kept.back()], poses[i]) <= max_motion;
    if (!stood_for) kept.push_back(i);
  }
  return kept;
}

namespace {

std::string named(std::size_t from) {
  return "poses " + std::to_string(from) + " and " + std::to_string(from + 1) +
         " (counting from 0)";
}

std::vector<double> motions_of(std::span<const Pose> poses, const Box& model) {
  std::vector<double> motions;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    motions.push_back(motion_bound(model, poses[i], poses[i + 1]));
    if (!std::isfinite(motions.back())) {
      throw InputError(named(i) + ": too far apart for the motion between them to be a number");
    }
  }
  return motions;
}

/// The motion of the model up to each of `cells` + 1 even steps of a curve's parameter, metres.
std::vector<double> travelled(const PoseCurve& curve, const Box& model, std::size_t cells) {
  std::vector<double> sums{0};
  Pose previous = curve.at(0);
  for (std::size_t k = 1; k <= cells; ++k) {
    const Pose pose = curve.at(static_cast<double>(k) / static_cast<double>(cells));
    sums.push_back(sums.back() + motion_bound(model, previous, pose));
    previous = pose;
  }
  return sums;
}

constexpr std::size_t kFewCells = 16, kMostCells = 1 << 16;

class Resampler {
 public:
  Resampler(std::span<const Pose> poses, const Box& model, double max_motion, Progress& progress)
      : poses_(poses),
        model_(model),
        max_motion_(max_motion),
        progress_(progress),
        motions_(motions_of(poses, model)),
        spline_(poses, motions_) {}

  void refuse_more_than(std::uint64_t most_added) const {
    double total = 0, longest = 0;
    std::size_t at = 0;
    for (std::size_t i = 0; i < motions_.size(); ++i) {
      if (motions_[i] <= max_motion_) continue;
      throw_if_stopped(progress_);
      const double length = travelled(spline_.between(i), model_, kFewCells).back();
      total += length;
      if (length > longest) at = i;
      longest = std::max(longest, length);
    }
    if (total / max_motion_ <= static_cast<double>(most_added)) return;
    const double enough = total / static_cast<double>(most_added) * 1.01;
    throw UsageError("a motion of " + format_digits(max_motion_, 3) +
                     " m at the most takes more than " + std::to_string(most_added) +
                     " additional poses; the farthest apart, " + format_digits(longest, 3) +
                     " m, are " + named(at) + "; expected " + format_digits(enough, 3) +
                     " or more");
  }

  std::vector<Pose> resampled() {
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      out_.push_back(poses_[i]);
      if (i < motions_.size() && motions_[i] > max_motion_) add_between(i);
      progress_.advance(1);
    }
    return std::move(out_);
  }

 private:
  void add_between(std::size_t i) {
    const PoseCurve curve = spline_.between(i);
    std::vector<double> sums;
    for (std::size_t cells = kFewCells; cells <= kMostCells; cells *= 2) {
      sums = travelled(curve, model_, cells);
      if (static_cast<double>(cells) >= 4 * sums.back() / max_motion_) break;
    }
    const std::size_t start = out_.size();
    const double fewest = std::max(2.0, std::ceil(sums.back() / max_motion_));
    const auto most = static_cast<std::uint64_t>(4 * fewest + 64);
    for (auto steps = static_cast<std::uint64_t>(fewest); steps <= most; steps += 1 + steps / 32) {
      if (add_steps(curve, sums, steps, poses_[i + 1])) return;
      out_.resize(start);
    }
    throw UsageError("a motion of " + format_digits(max_motion_, 3) + " m at the most: between " +
                     named(i) +
                     " rounding alone moves the model by about as much; expected a larger one");
  }

  /// Adds even steps up to `end`. Returns false if one of them is longer than allowed.
  bool add_steps(const PoseCurve& curve, const std::vector<double>& sums, std::uint64_t steps,
                 const Pose& end) {
    std::size_t cell = 0;
    for (std::uint64_t k = 1; k < steps; ++k) {
      throw_if_stopped(progress_);
      const double sum = sums.back() * (static_cast<double>(k) / static_cast<double>(steps));
      while (sums[cell + 1] < sum) ++cell;
      const double part = (sum - sums[cell]) / (sums[cell + 1] - sums[cell]);
      const Pose pose =
          curve.at((static_cast<double>(cell) + part) / static_cast<double>(sums.size() - 1));
      if (!(motion_bound(model_, out_.back(), pose) <= max_motion_)) return false;
      out_.push_back(pose);
    }
    return motion_bound(model_, out_.back(), end) <= max_motion_;
  }

  std::span<const Pose> poses_;
  const Box& model_;
  double max_motion_;
  Progress& progress_;
  std::vector<double> motions_;
  PoseSpline spline_;
  std::vector<Pose> out_;
};

}  // namespace

std::vector<Pose> resample_trajectory(std::span<const Pose> poses, const Box& model,
                                      double max_motion, Progress& progress,
                                      std::uint64_t most_added) {
  progress.begin("resample", poses.size(), "poses");
  Resampler resampler(poses, model, max_motion, progress);
  resampler.refuse_more_than(most_added);
  std::vector<Pose> out = resampler.resampled();
  progress.end();
  return out;
}

}  // namespace clearway
