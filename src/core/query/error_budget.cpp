#include "core/query/error_budget.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/geometry/point_box.hpp"
#include "core/trajectory/trajectory_doubts.hpp"
#include "core/trajectory/trajectory_summary.hpp"

namespace clearway {
namespace {

/// Calls visit(poses) for each run of a body's poses that follow one another on the path. Between
/// two runs the body has no pose, so there is no way that the search could leave out.
template <typename Visit>
void for_each_run(const MovingBody& body, Visit visit) {
  std::size_t first = 0;
  for (std::size_t i = 1; i <= body.poses.size(); ++i) {
    const bool follows = i < body.poses.size() &&
                         (body.path_pose.empty() || body.path_pose[i] == body.path_pose[i - 1] + 1);
    if (follows) continue;
    visit(body.poses.subspan(first, i - first));
    first = i;
  }
}

}  // namespace

std::optional<ErrorBudget> given_errors(const QueryParameters& query) {
  if (!query.has_budget()) return std::nullopt;
  ErrorBudget budget;
  budget.scan = query.error_scan.value_or(0);
  budget.registration = query.error_registration.value_or(0);
  budget.pose = query.error_pose.value_or(0);
  budget.angle = query.error_angle.value_or(0);
  budget.model = query.error_model.value_or(0);
  budget.sigmas = query.sigmas;
  return budget;
}

std::optional<ErrorBudget> error_budget_of(const Query& query, const Quantisation& quantisation) {
  std::optional<ErrorBudget> out = given_errors(query);
  if (!out) return out;
  const double* step = quantisation.scale;
  out->step = std::sqrt(step[0] * step[0] + step[1] * step[1] + step[2] * step[2]) / 2;
  out->spacing = model_spacing(query);
  for (const MovingBody& body : moving_bodies(query)) {
    if (body.model.empty()) continue;
    const double reach = farthest_from_origin(body.model.vertices);
    const Box box = box_of(body.model.vertices);
    out->lever = std::max(out->lever, reach);
    for_each_run(body, [&](std::span<const Pose> poses) {
      if (!query.between_poses) out->motion = std::max(out->motion, largest_motion(box, poses) / 2);
      for (const double deviation : chord_deviations(poses, reach)) {
        out->chord = std::max(out->chord, deviation);
      }
    });
  }
  return out;
}

}  // namespace clearway
