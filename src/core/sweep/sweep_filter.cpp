#include "core/sweep/sweep_filter.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/query/hit_set.hpp"
#include "core/sweep/tolerance.hpp"
#include "core/util/bit_reversal_order.hpp"

namespace clearway {
namespace {

using Verdict = SweepRef::Verdict;

/// Per pose the first of the equal ones that it follows without a break.
std::vector<std::uint32_t> first_equal_poses(std::span<const Pose> poses) {
  std::vector<std::uint32_t> first(poses.size());
  for (std::uint32_t i = 0; i < first.size(); ++i) {
    first[i] = i > 0 && poses[i] == poses[i - 1] ? first[i - 1] : i;
  }
  return first;
}

double rounding_of(const Query& query, const MotionTree& motion, const ModelField& field,
                   const PackedCloud& cloud) {
  const double rounding =
      motion.rounding(largest_coordinate(cloud) + search_radius(query), field.margin()) + 1e-150;
  // Between poses, the part of a computed hit's error that does not grow with the step.
  return query.between_poses ? rounding + 8 * kUnitRoundoff * query.radius : rounding;
}

}  // namespace

SweepFilter::SweepFilter(const Query& query, const MotionTree& motion, const ModelTree& model,
                         const ModelField& field, const PackedCloud& cloud)
    : query_(query),
      motion_(motion),
      model_(model),
      ref_{.motion = motion.ref(),
           .model = model.ref(),
           .field = field.ref(),
           .radius = search_radius(query),
           .resolved_from = query.radius,
           .clearance = query.clearance,
           .profile = query.profile,
           .rounding = rounding_of(query, motion, field, cloud),
           .first_pose = query.first_pose,
           .between_poses = query.between_poses},
      for_plan_(ref_) {
  for_plan_.field = field.ref_as_made();
  if (query.clearance > 0) first_equal_pose_ = first_equal_poses(query.poses);
}

void SweepFilter::narrow(const Box& box, std::span<const std::uint32_t> nodes,
                         std::vector<std::uint32_t>& out, SweepStatistics& statistics) const {
  narrow(ref_, box, nodes, 0, out, statistics);
}

void SweepFilter::narrow(const Box& box, std::span<const std::uint32_t> nodes,
                         std::vector<std::uint32_t>& out) const {
  SweepStatistics not_counted;
  narrow(for_plan_, box, nodes, ref_.profile * kRoundedUp, out, not_counted);
}

/// at_least: a distance within which every pose matters.
void SweepFilter::narrow(const SweepRef& ref, const Box& box, std::span<const std::uint32_t> nodes,
                         double at_least, std::vector<std::uint32_t>& out,
                         SweepStatistics& statistics) {
  out.clear();
  const Vec3 centre = centre_of(box);
  const double rho = half_diagonal(box);
  const double limit = std::max(
      at_least, ref.clearance > 0
                    ? ref.clearance_limit(centre, rho, nodes.data(),
                                          static_cast<std::uint32_t>(nodes.size()), statistics)
                    : ref.radius);
  for (const std::uint32_t node : nodes) {
    narrow_node(ref, centre, rho, limit, node, out, statistics);
  }
}

void SweepFilter::narrow_node(const SweepRef& ref, const Vec3& centre, double rho, double limit,
                              std::uint32_t index, std::vector<std::uint32_t>& out,
                              SweepStatistics& statistics) {
  ++statistics.node_tests;
  const MotionNode& node = ref.motion.nodes[index];
  switch (ref.classify_box(node, centre, rho, limit)) {
    case SweepRef::BoxClass::kDismissed:
      return;
    case SweepRef::BoxClass::kKept:
      out.push_back(index);
      return;
    case SweepRef::BoxClass::kSplit:
      narrow_node(ref, centre, rho, limit, index + 1, out, statistics);
      narrow_node(ref, centre, rho, limit, node.later, out, statistics);
  }
}

Verdict SweepFilter::test(const Vec3& e, const MotionNode& node, SweepStatistics& statistics,
                          double& squared_lower) const {
  const Verdict verdict = ref_.look(e, node, statistics, squared_lower);
  if (verdict != Verdict::kOpen || node.count > 1) return verdict;
  ++statistics.exact_tests;
  return ref_.collides_at(e, node) ? Verdict::kHitAtMid : Verdict::kDismissed;
}

/// First the middle poses of all nodes, far apart ones first: most points that collide do so at one
/// of them. Then what stayed open, in halves.
bool SweepFilter::touches(const Vec3& e, std::span<const std::uint32_t> nodes,
                          SweepStatistics& statistics) const {
  ++statistics.points_tested;
  double squared_lower = 0;
  while (!nodes.empty()) {
    const std::span part =
        nodes.first(std::min<std::size_t>(nodes.size(), BitReversalOrder::kMost));
    nodes = nodes.subspan(part.size());
    std::uint64_t open = 0;  // as bits
    bool hit = false;
    BitReversalOrder(static_cast<std::uint32_t>(part.size())).for_each([&](std::uint32_t i) {
      const Verdict verdict = test(e, motion_.nodes()[part[i]], statistics, squared_lower);
      hit = verdict == Verdict::kHitAtMid;
      open |= std::uint64_t{verdict == Verdict::kOpen} << i;
      return !hit;
    });
    if (hit) return true;
    for (; open != 0; open &= open - 1) {
      const std::uint32_t node = part[static_cast<std::size_t>(std::countr_zero(open))];
      if (touches_below(e, node, statistics)) return true;
    }
  }
  return false;
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

/// Lowers `best` to the least pose of the node whose way touches e, where that is less.
void SweepFilter::first_pose_below(const Vec3& e, std::uint32_t index, std::uint32_t& best,
                                   SweepStatistics& statistics) const {
  const MotionNode& node = motion_.nodes()[index];
  if (node.first >= best) return;
  const Verdict verdict = ref_.look(e, node, statistics);
  if (verdict == Verdict::kDismissed) return;
  if (verdict == Verdict::kHitAtMid) best = std::min(best, ref_.first_pose_of_hit(node.mid));
  if (node.count > 1) {
    first_pose_below(e, index + 1, best, statistics);
    first_pose_below(e, node.later, best, statistics);
  } else if (verdict == Verdict::kOpen) {
    ++statistics.exact_tests;
    if (ref_.collides_at(e, node)) best = node.first;
  }
}

}  // namespace clearway
