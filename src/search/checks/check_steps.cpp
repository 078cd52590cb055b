#include <cmath>
#include <string>

#include "core/geometry/rigid.hpp"
#include "core/util/format.hpp"
#include "search/checks/checks.hpp"
#include "search/checks/words.hpp"

namespace clearway {
namespace {

/// Never below the way of any model point from a pose to the next: cheap, for the many short steps.
double coarse_bound(const Pose& a, const Pose& b, double reach) {
  double turned = 0, moved = 0;
  for (int k = 0; k < 9; ++k) {
    const double d = b.rotation[k] - a.rotation[k];
    turned += d * d;
  }
  for (int k = 0; k < 3; ++k) {
    const double d = b.translation[k] - a.translation[k];
    moved += d * d;
  }
  return std::sqrt(moved) + std::sqrt(turned) * reach;
}

}  // namespace

void check_steps(const Question& question, MessageLog& log) {
  const Query& query = question.query;
  if (query.between_poses || query.poses.size() < 2) return;
  const Vec3 far = reach_of(question.model);
  const double reach = std::sqrt(squared_length(far.x, far.y, far.z));
  std::uint64_t large = 0;
  double largest = 0;
  std::uint64_t steps = 0;
  std::uint32_t at = 0;
  for (std::uint32_t i = 0; i + 1 < query.poses.size(); ++i) {
    if (question.number_of(i + 1) != question.number_of(i) + 1) continue;  // it is not there
    ++steps;
    const Pose &a = query.poses[i], &b = query.poses[i + 1];
    if (coarse_bound(a, b, reach) <= query.radius) continue;
    const double step = displacement_bound(question.model, a, b);
    if (!(step > query.radius)) continue;
    ++large;
    if (step > largest) {
      largest = step;
      at = question.number_of(i);
    }
  }
  if (large == 0) return;
  log.warn("large-steps",
           "at " + format_count(large) + " of " + format_count(steps) +
               " steps the model moves farther than the radius of " +
               length_text(query.radius, question.unit) + ", at most " +
               length_text(largest, question.unit) + " after pose " + std::to_string(at) +
               ". What lies between two poses can be missed",
           {{"share", static_cast<double>(large) / static_cast<double>(steps)},
            {"largest", largest},
            {"pose", static_cast<double>(at)}});
}

}  // namespace clearway
