#include "core/sweep/clearance_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/predicate.hpp"
#include "core/geometry/sweep_bounds.hpp"

namespace clearway {
namespace {

/// Up to this many poses are searched at once, where no more than kMostNearPoints model points can
/// be the nearest at any of them.
constexpr std::uint32_t kPosesAtOnce = 32;
constexpr std::size_t kMostNearPoints = 256;

}  // namespace

ClearanceSearch::ClearanceSearch(const SweepFilter& filter)
    : filter_(filter),
      motion_(filter.motion()),
      limit_(rounded_product(filter.ref().clearance, filter.ref().clearance)),
      guess_(filter.model().point(0)) {}

Clearance ClearanceSearch::nearest(const Vec3& e, std::span<const std::uint32_t> nodes,
                                   SweepStatistics& statistics) {
  ++statistics.points_tested;
  statistics_ = &statistics;
  e_ = e;
  set_best(limit_, 0);  // pose 0, so that a tie with the limit is no improvement
  if (!nodes.empty()) offer(guess_pose_, guess_);
  looks_.clear();
  for (const std::uint32_t node : nodes) {
    const Look seen = look(node);
    if (!is_given_up(seen)) looks_.push_back(seen);
  }
  const auto nearest_first = std::min_element(
      looks_.begin(), looks_.end(),
      [](const Look& a, const Look& b) { return a.squared_lower < b.squared_lower; });
  if (nearest_first != looks_.end()) std::iter_swap(looks_.begin(), nearest_first);
  for (const Look& seen : looks_) visit(seen);
  return best_.squared < limit_ ? best_ : Clearance{};
}

ClearanceSearch::Look ClearanceSearch::look(std::uint32_t index) {
  ++statistics_->point_tests;
  const std::uint32_t mid = motion_.nodes()[index].mid;
  const ModelField::Bounds bounds = filter_.ref().field.bounds(motion_.pulled_back(mid, e_));
  const Look seen{index, bounds.near, bounds.squared_lower};
  if (bounds.near != ModelField::kNone && !is_given_up(seen)) {
    offer(filter_.first_equal_pose(mid), filter_.model().point(bounds.near));
  }
  return seen;
}

bool ClearanceSearch::is_given_up(const Look& seen) const {
  const MotionNode& node = motion_.nodes()[seen.node];
  return farther(motion_.inverse_pose(node.mid).least, seen.squared_lower, reach_ + node.delta);
}

void ClearanceSearch::visit(const Look& seen) {
  if (is_given_up(seen)) return;
  const MotionNode& node = motion_.nodes()[seen.node];
  const std::uint32_t pose = filter_.first_equal_pose(node.first);
  if (pose == filter_.first_equal_pose(node.first + node.count - 1)) {
    search_pose(pose, seen.near);
  } else if (node.count > kPosesAtOnce || !search_poses(node)) {
    visit_halves(seen.node);
  }
}

/// One search of the model for the box of the point pulled back by every pose of the node: along a
/// surface that the path follows, bounds of single poses decide nothing. False, and nothing done,
/// where too many model points are open.
bool ClearanceSearch::search_poses(const MotionNode& node) {
  ++statistics_->exact_tests;
  pulled_back_.clear();
  Box box{};
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t pose = node.first; pose < node.first + node.count; ++pose) {
    const Vec3 x = motion_.pulled_back(pose, e_);
    for (int k = 0; k < 3; ++k) {
      if (std::isnan(x[k])) return false;
      box.lo[k] = pulled_back_.empty() ? x[k] : std::min(box.lo[k], x[k]);
      box.hi[k] = pulled_back_.empty() ? x[k] : std::max(box.hi[k], x[k]);
    }
    least = std::min(least, motion_.inverse_pose(pose).least);
    pulled_back_.push_back(x);
  }
  const auto squared_ball = [&] {
    const double ball = reach_ / least * kRoundedUp;
    return ball * ball * kRoundedUp;
  };
  if (!(squared_ball() >= 0)) return false;
  if (!filter_.model().within(box, squared_ball(), kMostNearPoints, near_points_)) return false;
  if (near_points_.empty()) return true;
  for (std::uint32_t i = 0; i < node.count; ++i) {
    const std::uint32_t pose = filter_.first_equal_pose(node.first + i);
    const double squared = squared_ball();
    for (const Vec3& m : near_points_) {
      if (!(squared_distance(m, pulled_back_[i]) > squared)) offer(pose, m);
    }
  }
  return true;
}

void ClearanceSearch::visit_halves(std::uint32_t node) {
  const Look earlier = look(node + 1);
  const Look later = look(motion_.nodes()[node].later);
  const bool later_first = later.squared_lower < earlier.squared_lower;
  visit(later_first ? later : earlier);
  visit(later_first ? earlier : later);
}

/// The model point nearest to e pulled back need not have the least computed d2, nor do others near
/// it: every one within the rounding bound, and the stretch, of the best is put to the predicate.
void ClearanceSearch::search_pose(std::uint32_t pose, std::uint32_t near) {
  ++statistics_->exact_tests;
  const ModelTree& model = filter_.model();
  const double least = motion_.inverse_pose(pose).least;
  const Vec3 x = motion_.pulled_back(pose, e_);
  const ModelTree::Nearest nearest = model.nearest(x, near == ModelField::kNone ? 0 : near);
  if (farther(least, nearest.squared_distance, reach_)) return;
  offer(pose, model.point(nearest.point));
  const double ball = reach_ / least * kRoundedUp;
  model.ref().any_within(x, ball * ball * kRoundedUp, [&](const Vec3& m) {
    offer(pose, m);
    return false;
  });
}

void ClearanceSearch::offer(std::uint32_t pose, const Vec3& m) {
  const double squared = squared_distance(e_, transform(motion_.poses()[pose], m));
  const bool better = squared < best_.squared;
  if (!better && !(squared == best_.squared && pose < best_.pose)) return;
  guess_pose_ = pose;
  guess_ = m;
  set_best(squared, pose);
}

void ClearanceSearch::set_best(double squared, std::uint32_t pose) {
  best_ = {squared, pose};
  reach_ = std::sqrt(squared) * kRoundedUp + filter_.ref().rounding;
}

}  // namespace clearway
