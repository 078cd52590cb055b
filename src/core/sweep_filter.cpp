#include "core/sweep_filter.hpp"

#include <algorithm>
#include <cmath>

#include "core/hit_set.hpp"
#include "core/predicate.hpp"
#include "core/sweep_bounds.hpp"
#include "core/swept_step.hpp"

namespace clearway {
namespace {

/// A node of the motion tree is split for a box while it moves more than this many times the box's
/// half diagonal.
constexpr double kMotionPerBox = 1.0;

double largest_coordinate(const PackedCloud& cloud) {
  if (cloud.tree().empty()) return 0;
  const Box box = position_box(cloud.quantisation(), cloud.tree()[0].box);
  double largest = 0;
  for (int k = 0; k < 3; ++k) {
    largest = std::max({largest, std::abs(box.lo[k]), std::abs(box.hi[k])});
  }
  return largest;
}

/// Per pose the first of the equal ones that it follows without a break.
std::vector<std::uint32_t> first_equal_poses(std::span<const Pose> poses) {
  std::vector<std::uint32_t> first(poses.size());
  for (std::uint32_t i = 0; i < first.size(); ++i) {
    first[i] = i > 0 && poses[i] == poses[i - 1] ? first[i - 1] : i;
  }
  return first;
}

}  // namespace

void SweepStatistics::add(const SweepStatistics& other) {
  node_tests += other.node_tests;
  point_tests += other.point_tests;
  exact_tests += other.exact_tests;
  points_tested += other.points_tested;
}

SweepFilter::SweepFilter(const Question& question, const MotionTree& motion, const ModelTree& model,
                         const ModelField& field, const PackedCloud& cloud)
    : question_(question),
      motion_(motion),
      model_(model),
      field_(field),
      rounding_(
          motion.rounding(largest_coordinate(cloud) + std::max(question.radius, question.clearance),
                          32 * field.voxel() + question.clearance) +
          1e-150) {
  if (question.clearance > 0) first_equal_pose_ = first_equal_poses(question.poses);
  // The part of a computed hit's error between poses that does not grow with the step.
  if (question.between_poses) rounding_ += 8 * kUnitRoundoff * question.radius;
}

bool SweepFilter::moves_on(const MotionNode& node) const {
  return question_.between_poses && node.count == 1 && node.first + 1 < question_.poses.size();
}

void SweepFilter::narrow(const Box& box, std::span<const std::uint32_t> nodes,
                         std::vector<std::uint32_t>& out, SweepStatistics& statistics) const {
  out.clear();
  const Vec3 centre = centre_of(box);
  const double rho = half_diagonal(box);
  const double limit =
      question_.clearance > 0 ? clearance_limit(centre, rho, nodes, statistics) : question_.radius;
  for (const std::uint32_t node : nodes) narrow_node(centre, rho, limit, node, out, statistics);
}

/// A distance beyond which nothing matters to any point of the box: the clearance asked for, or
/// what a pair found at a mid keeps them all below; never less than a radius still to be searched.
double SweepFilter::clearance_limit(const Vec3& centre, double rho,
                                    std::span<const std::uint32_t> nodes,
                                    SweepStatistics& statistics) const {
  double squared = std::numeric_limits<double>::infinity();
  for (const std::uint32_t index : nodes) {
    ++statistics.node_tests;
    const std::uint32_t mid = motion_.nodes()[index].mid;
    const std::uint32_t near = field_.bounds(motion_.pulled_back(mid, centre)).near;
    if (near == ModelField::kNone) continue;
    const Vec3 moved = transform(question_.poses[mid], model_.point(near));
    squared = std::min(squared, squared_distance(centre, moved));
  }
  const double upper = std::sqrt(squared) * kRoundedUp + rho + rounding_;
  const double limit = std::min(question_.clearance * kRoundedUp, upper);
  return hits_follow_from_clearance(question_) ? limit : std::max(limit, question_.radius);
}

void SweepFilter::narrow_node(const Vec3& centre, double rho, double limit, std::uint32_t index,
                              std::vector<std::uint32_t>& out, SweepStatistics& statistics) const {
  const MotionNode& node = motion_.nodes()[index];
  ++statistics.node_tests;
  const Vec3 x = motion_.pulled_back(node.mid, centre);
  const double reach = limit + node.delta + rho + rounding_;
  if (farther(motion_.pull_back(node.mid).least, field_.bounds(x).squared_lower, reach)) return;
  if (node.count > 1 && !(node.delta <= kMotionPerBox * rho)) {
    narrow_node(centre, rho, limit, index + 1, out, statistics);
    narrow_node(centre, rho, limit, node.later, out, statistics);
    return;
  }
  const bool long_step = moves_on(node) && !(node.delta <= kMotionPerBox * rho);
  if (long_step &&
      !SweptStep(question_, motion_, model_, node.first, rounding_).may_touch(centre, rho)) {
    return;
  }
  out.push_back(index);
}

SweepFilter::Verdict SweepFilter::test(const Vec3& e, const MotionNode& node,
                                       SweepStatistics& statistics, double& squared_lower) const {
  ++statistics.point_tests;
  const Vec3 x = motion_.pulled_back(node.mid, e);
  const double least = motion_.pull_back(node.mid).least;
  const double reach = question_.radius + node.delta + rounding_;
  const ModelField::Bounds bounds = field_.bounds(x);
  squared_lower = bounds.squared_lower;
  if (farther(least, bounds.squared_lower, reach)) return Verdict::kDismissed;
  const Pose& pose = question_.poses[node.mid];
  const auto hits = [&](const Vec3& m) {
    return collides(e, transform(pose, m), question_.radius);
  };
  if (bounds.near != ModelField::kNone && hits(model_.point(bounds.near))) {
    return Verdict::kHitAtMid;
  }
  if (node.count == 1) {
    ++statistics.exact_tests;
    if (moves_on(node)) {
      const SweptStep step(question_, motion_, model_, node.first, rounding_);
      return step.touches(e) ? Verdict::kHitAtMid : Verdict::kDismissed;
    }
    const double ball = (question_.radius + rounding_) / least * (1 + 16 * kUnitRoundoff);
    return model_.any_within(x, ball * ball * (1 + 16 * kUnitRoundoff), hits) ? Verdict::kHitAtMid
                                                                              : Verdict::kDismissed;
  }
  return Verdict::kOpen;
}

bool SweepFilter::touches(const Vec3& e, std::span<const std::uint32_t> nodes,
                          SweepStatistics& statistics) const {
  ++statistics.points_tested;
  double squared_lower = 0;
  return std::any_of(nodes.begin(), nodes.end(), [&](std::uint32_t node) {
    const Verdict verdict = test(e, motion_.nodes()[node], statistics, squared_lower);
    return verdict == Verdict::kHitAtMid ||
           (verdict == Verdict::kOpen && touches_below(e, node, statistics));
  });
}

/// Tests both halves of an open node, then goes into the nearer one first.
bool SweepFilter::touches_below(const Vec3& e, std::uint32_t index,
                                SweepStatistics& statistics) const {
  const MotionNode* nodes = motion_.nodes().data();
  std::uint32_t half[2] = {index + 1, nodes[index].later};
  double squared[2];
  bool open[2];
  for (int i = 0; i < 2; ++i) {
    const Verdict verdict = test(e, nodes[half[i]], statistics, squared[i]);
    if (verdict == Verdict::kHitAtMid) return true;
    open[i] = verdict == Verdict::kOpen;
  }
  const int nearer = squared[1] < squared[0] ? 1 : 0;
  return (open[nearer] && touches_below(e, half[nearer], statistics)) ||
         (open[1 - nearer] && touches_below(e, half[1 - nearer], statistics));
}

std::uint32_t SweepFilter::first_pose(const Vec3& e, std::span<const std::uint32_t> nodes,
                                      SweepStatistics& statistics) const {
  ++statistics.points_tested;
  std::uint32_t best = HitSet::kNever;
  for (const std::uint32_t node : nodes) {
    if (motion_.nodes()[node].first >= best) break;
    first_pose_below(e, node, best, statistics);
  }
  return best;
}

/// Lowers `best` to the smallest touching pose of the node's that is below it.
void SweepFilter::first_pose_below(const Vec3& e, std::uint32_t index, std::uint32_t& best,
                                   SweepStatistics& statistics) const {
  const MotionNode& node = motion_.nodes()[index];
  if (node.first >= best) return;
  double squared_lower = 0;
  const Verdict verdict = test(e, node, statistics, squared_lower);
  if (verdict == Verdict::kDismissed) return;
  if (verdict == Verdict::kHitAtMid) best = std::min(best, node.mid);
  if (node.count == 1) return;
  first_pose_below(e, index + 1, best, statistics);
  first_pose_below(e, node.later, best, statistics);
}

}  // namespace clearway
