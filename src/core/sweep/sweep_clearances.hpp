#pragma once

#include <cmath>
#include <cstdint>

#include "core/sweep/sweep_page.hpp"
#include "core/sweep/sweep_walk.hpp"

namespace clearway {

/// The clearances of the 32 points of a half block over the poses of some subtrees, as
/// docs/design/numerics.md ("Clearance") derives them: improves those in the answer of the page. A
/// lane a point; no other warp works on the same points.
template <typename Warp>
class SweepClearances {
 public:
  template <typename Value>
  using PerLane = typename Warp::template PerLane<Value>;

  CLEARWAY_HD SweepClearances(const SweepPage& job, std::uint32_t half,
                              PerLane<SweepStatistics>& statistics)
      : job_(job),
        block_(half / SweepWork::kHalves),
        first_(half % SweepWork::kHalves * kWarpLanes),
        cell_(job.cell_of_block(block_)),
        limit_(rounded_product(job.sweep.clearance, job.sweep.clearance)),
        statistics_(statistics) {}

  CLEARWAY_HD void search(const SweepSubtrees& subtrees) {
    const std::uint32_t begin = job_.first_point(block_) + first_;
    if (begin >= cell_.count) return;
    Warp::each([&](std::uint32_t lane) {
      best_[lane] = Clearance{limit_, 0};  // pose 0, so that a tie with the limit is no improvement
      wanted_[lane] = begin + lane < cell_.count;
      if (!wanted_[lane]) return;
      ++statistics_[lane].points_tested;
      points_[lane] = job_.point(cell_, begin + lane);
      const Clearance known = job_.clearances[slot(lane)];
      if (known.squared < limit_) best_[lane] = known;
    });
    look_at_tops<Warp>(
        subtrees, ways_, [&](std::uint32_t lane) { return wanted_[lane]; },
        [&](std::uint32_t lane, std::uint32_t at) { return look(lane, at); });
    walk<Warp>(
        job_.sweep.motion, subtrees, ways_,
        [&](std::uint32_t lane, SweepWay& way) { step(lane, way); },
        [](std::uint32_t) { return false; },
        [&](std::uint32_t lane, std::uint32_t at) {
          ++statistics_[lane].exact_tests;
          search_pose(lane, job_.sweep.motion.nodes[at].mid);
        });
    mark();
  }

 private:
  CLEARWAY_HD std::uint32_t slot(std::uint32_t lane) const {
    return block_ * kBlockPoints + first_ + lane;
  }

  /// A pose at which no model point is nearer than this has only larger d2.
  CLEARWAY_HD double reach(std::uint32_t lane) {
    return std::sqrt(best_[lane].squared) * kRoundedUp + job_.sweep.rounding;
  }

  CLEARWAY_HD void offer(std::uint32_t lane, std::uint32_t pose, const Vec3& m) {
    const double squared =
        squared_distance(points_[lane], transform(job_.sweep.motion.poses[pose], m));
    Clearance& known = best_[lane];
    if (squared < known.squared || (squared == known.squared && pose < known.pose)) {
      known = Clearance{squared, pose};
    }
  }

  CLEARWAY_HD void step(std::uint32_t lane, SweepWay& way) {
    const std::uint32_t count = job_.sweep.motion.nodes[way.at].count;
    if (!look(lane, way.at)) {
      way.at += 2 * count - 1;
    } else if (count == 1) {
      way.waits = true;
    } else {
      ++way.at;
    }
  }

  /// Whether a pose of the node may still have the least d2.
  CLEARWAY_HD bool look(std::uint32_t lane, std::uint32_t at) {
    ++statistics_[lane].point_tests;
    const SweepRef& sweep = job_.sweep;
    const MotionNode& node = sweep.motion.nodes[at];
    const InversePose& back = sweep.motion.inverse_poses[node.mid];
    const ModelFieldRef::Bounds bounds = sweep.field.bounds(back.apply(points_[lane]));
    if (farther(back.least, bounds.squared_lower, reach(lane) + node.delta)) return false;
    if (bounds.near != ModelFieldRef::kNone) offer(lane, node.mid, sweep.model.points[bounds.near]);
    return true;
  }

  /// Offers every model point that may have the least d2 at one pose.
  CLEARWAY_HD void search_pose(std::uint32_t lane, std::uint32_t pose) {
    const SweepRef& sweep = job_.sweep;
    const InversePose& back = sweep.motion.inverse_poses[pose];
    const Vec3 x = back.apply(points_[lane]);
    const std::uint32_t near = sweep.field.bounds(x).near;
    const ModelTreeRef::Nearest nearest =
        sweep.model.nearest(x, near == ModelFieldRef::kNone ? 0 : near);
    if (farther(back.least, nearest.squared_distance, reach(lane))) return;
    offer(lane, pose, sweep.model.points[nearest.point]);
    const double ball = reach(lane) / back.least * kRoundedUp;
    sweep.model.any_within(x, ball * ball * kRoundedUp, [&](const Vec3& m) {
      offer(lane, pose, m);
      return false;
    });
  }

  CLEARWAY_HD void mark() {
    const double touching = rounded_product(job_.sweep.radius, job_.sweep.radius);
    const std::uint32_t closer = Warp::ballot([&](std::uint32_t lane) {
      if (!(best_[lane].squared < limit_)) return false;
      job_.clearances[slot(lane)] = best_[lane];
      return best_[lane].squared < touching;
    });
    if (!job_.sweep.hits_follow_from_clearance()) return;
    Warp::each([&](std::uint32_t lane) {
      if (lane == 0) job_.hits[block_] |= std::uint64_t{closer} << first_;
    });
  }

  const SweepPage& job_;
  std::uint32_t block_;
  std::uint32_t first_;  ///< point of the block
  const PageCell& cell_;
  double limit_;
  PerLane<SweepStatistics>& statistics_;
  PerLane<SweepWay> ways_;
  PerLane<Vec3> points_;
  PerLane<bool> wanted_;  ///< is a point
  PerLane<Clearance> best_;
};

}  // namespace clearway
