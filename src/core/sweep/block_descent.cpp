#include "core/sweep/block_descent.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "core/query/search_result.hpp"
#include "core/util/bit_reversal_order.hpp"
#include "core/util/lane_bits.hpp"

namespace clearway {
namespace {

/// Number of points up to which they are searched one by one (measured).
constexpr int kFewPoints = 2;

std::uint64_t bit(std::uint32_t i) { return std::uint64_t{1} << i; }

}  // namespace

template <typename Element>
void BlockDescentOf<Element>::begin(std::uint64_t which, std::span<const std::uint32_t> nodes,
                                    bool first_pose, SweepStatistics& statistics) {
  finished_ = ~which;
  hits_ = 0;
  first_pose_ = first_pose;
  std::ranges::fill(best_, kNoPose);
  std::ranges::fill(tests_, 0);
  nodes_ = nodes;
  runs_.clear();
  statistics_ = &statistics;
  statistics.points_tested += static_cast<std::uint64_t>(std::popcount(which));
}

template <typename Element>
std::uint64_t BlockDescentOf<Element>::touches(std::uint64_t which,
                                               std::span<const std::uint32_t> nodes,
                                               SweepStatistics& statistics) {
  begin(which, nodes, false, statistics);
  // All nodes are looked at first, those far apart first, because most points that collide do so at
  // one of their middle poses.
  while (!nodes.empty() && finished_ != ~std::uint64_t{0}) {
    const std::span part =
        nodes.first(std::min<std::size_t>(nodes.size(), BitReversalOrder::kMost));
    nodes = nodes.subspan(part.size());
    std::array<std::uint64_t, BitReversalOrder::kMost> open{};
    double squared_lower;
    BitReversalOrder(static_cast<std::uint32_t>(part.size())).for_each([&](std::uint32_t i) {
      open[i] = look(part[i], which, squared_lower);
      return finished_ != ~std::uint64_t{0};
    });
    for (std::size_t i = 0; i < part.size(); ++i) descend_nearer_first(part[i], open[i]);
  }
  return hits_;
}

template <typename Element>
std::uint64_t BlockDescentOf<Element>::find_first_poses(std::uint64_t searched,
                                                        std::span<const std::uint32_t> nodes,
                                                        std::span<std::uint32_t> first_poses,
                                                        SweepStatistics& statistics) {
  begin(searched, nodes, true, statistics);
  std::uint64_t which = searched;
  double squared_lower;
  for (const std::uint32_t node : nodes) {
    which = wanted(node, which);  // what is not wanted here is not wanted at a later node either
    if (which == 0) break;
    descend_in_order(node, look(node, which, squared_lower));
  }
  for_each_bit(searched, [&](std::uint32_t i) {
    first_poses[i] = best_[i];
    if (best_[i] != kNoPose) hits_ |= bit(i);
  });
  return hits_;
}

/// Those of `which` for which something may still be found at a node.
template <typename Element>
std::uint64_t BlockDescentOf<Element>::wanted(std::uint32_t node, std::uint64_t which) const {
  which &= ~finished_;
  if (!first_pose_) return which;
  const std::uint32_t first = sweep_.motion.nodes[node].first;
  for_each_bit(which, [&](std::uint32_t i) {
    if (best_[i] <= first) which &= ~bit(i);
  });
  return which;
}

template <typename Element>
void BlockDescentOf<Element>::keep_hit(std::uint32_t point, std::uint32_t pose) {
  if (first_pose_) {
    best_[point] = std::min(best_[point], pose);
  } else {
    hits_ |= bit(point);
    finished_ |= bit(point);
  }
}

/// Looks at a node for points of the block. Returns those for which its halves have to be looked
/// at. squared_lower: becomes the least bound of the field at the middle pose.
template <typename Element>
std::uint64_t BlockDescentOf<Element>::look(std::uint32_t index, std::uint64_t which,
                                            double& squared_lower) {
  squared_lower = kInfinity;
  which = wanted(index, which);
  if (which == 0) return 0;
  const MotionNode& node = sweep_.motion.nodes[index];
  statistics_->point_tests += static_cast<std::uint64_t>(std::popcount(which));
  std::uint64_t at_mid = which;  // points whose pair with the middle pose counts
  if (sweep_.has_floor()) {
    for_each_bit(which, [&](std::uint32_t i) {
      const FloorSide side = sweep_.counting(node, points_.point(i));
      if (side == FloorSide::kBelow) which &= ~bit(i);
      if (side != FloorSide::kAbove) at_mid &= ~bit(i);
    });
    if (which == 0) return 0;
  }
  const InversePose& back = sweep_.motion.inverse_poses[node.mid];
  lanes_.clear();
  for_each_bit(which, [&](std::uint32_t i) { lanes_.add(points_.point(i)); });
  lanes_.look_up(back);
  const std::uint64_t within = lanes_.within(back.least, sweep_.reach_of(node));
  if (!kIsSolid<Element> && within == 0) return 0;
  const std::uint64_t may_touch = lanes_.within(back.least, sweep_.radius + sweep_.rounding);
  std::uint64_t open = 0;
  std::uint32_t lane = 0;
  for_each_bit(which, [&](std::uint32_t i) {
    const std::uint32_t of_point = lane++;
    if (!kIsSolid<Element> && (within & bit(of_point)) == 0) return;
    if (kIsTriangle<Element>) ++tests_[i];
    const Vec3 e = points_.point(i);
    const double lower = lanes_.squared_lower(of_point);
    squared_lower = std::min(squared_lower, lower);
    const FloorSide side = (at_mid & bit(i)) != 0 ? FloorSide::kAbove : FloorSide::kOpen;
    const auto near = [&] {
      return (may_touch & bit(of_point)) != 0 ? lanes_.near(of_point) : ModelFieldRef::kNone;
    };
    const SweepVerdict verdict = sweep_.judge(e, node, side, lanes_.place(of_point), lower, near);
    if (verdict == SweepVerdict::kDismissed) return;
    if (verdict == SweepVerdict::kHitAtMid) keep_hit(i, sweep_.first_pose_of_hit(node.mid));
    if (node.count > 1) {
      if (node.first < best_[i]) open |= bit(i);
    } else if (verdict == SweepVerdict::kOpen) {
      ++statistics_->exact_tests;
      if (sweep_.collides_at(e, node)) keep_hit(i, node.first);
    }
  });
  return open;
}

/// Looks at both halves of a node, then goes on with the one that is nearer to one of the points.
template <typename Element>
void BlockDescentOf<Element>::descend_nearer_first(std::uint32_t node, std::uint64_t which) {
  which &= ~finished_;
  if (kIsTriangle<Element> || std::popcount(which) <= kFewPoints) {
    return descend_one_by_one(node, which);
  }
  const std::array<std::uint32_t, 2> halves = filter_.halves(node);
  double squared_lower[2];
  std::uint64_t open[2];
  for (int i = 0; i < 2; ++i) open[i] = look(halves[i], which, squared_lower[i]);
  const int nearer = squared_lower[1] < squared_lower[0] ? 1 : 0;
  descend_nearer_first(halves[nearer], open[nearer]);
  descend_nearer_first(halves[1 - nearer], open[1 - nearer]);
}

/// Looks at both halves of a node in the order of their poses, each with all below it.
template <typename Element>
void BlockDescentOf<Element>::descend_in_order(std::uint32_t node, std::uint64_t which) {
  if (kIsTriangle<Element> || std::popcount(which) <= kFewPoints) {
    return descend_one_by_one(node, which);
  }
  double squared_lower;
  for (const std::uint32_t half : filter_.halves(node)) {
    descend_in_order(half, look(half, which, squared_lower));
  }
}

/// Looks below a node for one point after the other. Exact tests of triangles are so costly that
/// the points gain nothing from being looked at together, and a point that grazes the model says
/// that it and its neighbours are better searched in runs of poses.
template <typename Element>
void BlockDescentOf<Element>::descend_one_by_one(std::uint32_t node, std::uint64_t which) {
  for_each_bit(which, [&](std::uint32_t i) {
    if (!runs_.empty()) return search_runs(i);
    const Vec3 e = points_.point(i);
    const SweepStatistics before = *statistics_;
    if (first_pose_) {
      filter_.lower_first_pose(e, node, best_[i], *statistics_);
    } else if (filter_.touches_below(e, node, *statistics_)) {
      keep_hit(i, 0);
    }
    if constexpr (kIsTriangle<Element>) {
      tests_[i] += SweepFilterOf<Element>::cost_of(statistics_->since(before));
      filter_.join_runs(tests_[i], nodes_, runs_);
    }
  });
}

/// Finds all there is to be found about a point by runs of poses.
template <typename Element>
void BlockDescentOf<Element>::search_runs(std::uint32_t i) {
  const Vec3 e = points_.point(i);
  if (first_pose_) {
    best_[i] = std::min(best_[i], filter_.first_pose_of_runs(e, runs_, *statistics_));
  } else if (filter_.touches_runs(e, runs_, *statistics_)) {
    hits_ |= bit(i);
  }
  finished_ |= bit(i);
}

template class BlockDescentOf<Vec3>;
template class BlockDescentOf<Triangle>;
template class BlockDescentOf<SolidTriangle>;

}  // namespace clearway
