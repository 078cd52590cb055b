#include "search/checks/rounded_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/geometry/angle.hpp"
#include "core/trajectory/trajectory_summary.hpp"
#include "core/util/format.hpp"

namespace clearway {
namespace {

/// Steps of rounded numbers, from the coarsest.
constexpr std::array<double, 5> kRoundedSteps{100, 10, 1, 0.1, 0.01};

bool is_multiple(double value, double step) {
  const double steps = value / step;
  return std::abs(steps - std::round(steps)) < 1e-6;
}

/// The coarsest step above `least` of which all coordinates of an axis are multiples; 0 where there
/// is none, and where the coordinates change less than three times or by more than one step at
/// once, as those of places that somebody chose may.
double step_of_axis(const std::vector<Pose>& poses, int axis, double least, double unit) {
  for (const double decimal : kRoundedSteps) {
    const double step = decimal * unit;
    if (step <= least) break;
    const auto is_rounded = [&](const Pose& pose) {
      return is_multiple(pose.translation[axis], step);
    };
    if (!std::ranges::all_of(poses, is_rounded)) continue;
    constexpr std::size_t kFewestChanges = 3;
    std::size_t changes = 0;
    for (std::size_t i = 1; i < poses.size(); ++i) {
      const double change = std::abs(poses[i].translation[axis] - poses[i - 1].translation[axis]);
      if (change > 1.5 * step) return 0;
      if (change > 0.5 * step) ++changes;
    }
    return changes >= kFewestChanges ? step : 0;
  }
  return 0;
}

/// Whether most poses are less than a step from the one before. A body that turns on the spot does
/// not move because it should not.
bool is_finer_than(const std::vector<Pose>& poses, double step) {
  constexpr double kTurns = 5 * kDegree;
  std::size_t shorter = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Pose &a = poses[i - 1], &b = poses[i];
    const bool is_short = squared_distance(a.position(), b.position()) < 0.25 * step * step;
    if (is_short && turn_between(a, b) < kTurns) ++shorter;
  }
  return 2 * shorter > poses.size();
}

}  // namespace

void warn_of_rounded_path(const Question& question, MessageLog& log) {
  const std::vector<Pose>& poses = question.query.poses;
  // A section has cells, which decide where it has no margin.
  const double radius =
      std::max(question.query.radius, question.is_load() ? question.section->cell : 0);
  double coarsest = 0;
  std::string axes;
  for (int axis = 0; axis < 3; ++axis) {
    double step = step_of_axis(poses, axis, radius, 1);
    if (step == 0) step = step_of_axis(poses, axis, radius, question.metre);
    if (step == 0 || !is_finer_than(poses, step)) continue;
    axes += (axes.empty() ? "" : ", ") + std::string(1, "xyz"[axis]);
    coarsest = std::max(coarsest, step);
  }
  if (coarsest == 0) return;
  log.warn("lost-digits",
           "all coordinates " + axes + " of the path are multiples of up to " +
               question.length(coarsest) +
               ", although its poses are mostly closer together, so they can be wrong by " +
               question.length(coarsest / 2) + ", with a radius of " + question.length(radius) +
               ". Export the path with more digits",
           {{"step", coarsest}, {"radius", radius}});
}

}  // namespace clearway
