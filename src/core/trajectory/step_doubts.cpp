#include "core/trajectory/step_doubts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/trajectory/trajectory_summary.hpp"
#include "core/util/format.hpp"
#include "core/util/number_ranges.hpp"

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
  return {row > 0 ? Message::Severity::kNote : Message::Severity::kWarning,
          "trajectory-jump",
          prefix + begin + format_brief(worst.length) + " " + unit + " long, " +
              format_brief(worst.length / worst.usual) + " times the median of the steps around " +
              "it, which is " + format_brief(worst.usual) + " " + unit + ". " + cause + consequence,
          {{"jumps", static_cast<double>(jumps.size())},
           {"pose", static_cast<double>(worst.pose)},
           {"step", worst.length},
           {"median_step", worst.usual}}};
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
      const bool tells = j == i || steps[j] >= kShareOfNeighbours * steps[i];
      if (tells && steps[i] > 0 && steps[j] > 0) {
        curvature = std::max(curvature, turns[j] / steps[j]);
      }
    }
    deviations.push_back(reach * (1 - std::cos(turns[i] / 2)) +
                         curvature * steps[i] * steps[i] / 8);
  }
  return deviations;
}

}  // namespace clearway
