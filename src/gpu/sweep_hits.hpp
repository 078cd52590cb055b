#pragma once

#include <cstdint>

#include "gpu/sweep_page.hpp"
#include "gpu/sweep_walk.hpp"

namespace clearway {

/// Which of the 32 points of a half block collide at the poses of some subtrees: marks them in the
/// answer of the page. A lane a point. Other warps may work on the same points.
template <typename Warp>
class SweepHits {
 public:
  template <typename Value>
  using PerLane = typename Warp::template PerLane<Value>;

  CLEARWAY_HD SweepHits(const SweepPage& job, std::uint32_t half,
                        PerLane<SweepStatistics>& statistics)
      : job_(job),
        block_(half / kHalves),
        first_(half % kHalves * kWarpLanes),
        cell_(job.cell_of_block(block_)),
        statistics_(statistics) {}

  /// Points of a block that other lanes take.
  static constexpr std::uint32_t kHalves = kBlockPoints / kWarpLanes;

  /// defer: put searches of the model at a single pose on the page's list while there is room.
  CLEARWAY_HD void search(const SweepSubtrees& subtrees, bool defer) {
    const std::uint32_t begin = job_.first_point(block_) + first_;
    if (begin >= cell_.count) return;
    const std::uint64_t known = job_.hits[block_] >> first_;
    Warp::each([&](std::uint32_t lane) {
      best_[lane] = SweepPage::kNever;
      wanted_[lane] =
          begin + lane < cell_.count && (job_.sweep.first_pose || (known >> lane & 1) == 0);
      if (!wanted_[lane]) return;
      if (job_.sweep.first_pose) best_[lane] = job_.first_poses[slot(lane)];
      ++statistics_[lane].points_tested;
      points_[lane] = job_.point(cell_, begin + lane);
    });
    look_at_tops<Warp>(
        subtrees, ways_, [&](std::uint32_t lane) { return wanted_[lane]; },
        [&](std::uint32_t lane, std::uint32_t at) {
          const MotionNode& node = job_.sweep.motion.nodes[at];
          if (node.first >= best_[lane]) return false;
          ++statistics_[lane].point_tests;
          const SweepRef::Verdict verdict = job_.sweep.look(points_[lane], node);
          if (verdict == SweepRef::Verdict::kDismissed) return false;
          if (verdict == SweepRef::Verdict::kOpen) return true;
          hit(lane, node.mid);
          return job_.sweep.first_pose && node.first < best_[lane];
        });
    walk<Warp>(
        job_.sweep.motion, subtrees, ways_,
        [&](std::uint32_t lane, SweepWay& way) { step(lane, way); },
        [&](std::uint32_t waiting) { return defer && deferred(waiting); },
        [&](std::uint32_t lane, std::uint32_t at) {
          ++statistics_[lane].exact_tests;
          const MotionNode& node = job_.sweep.motion.nodes[at];
          if (job_.sweep.touches_at(points_[lane], node)) hit(lane, node.mid);
        });
    mark();
  }

 private:
  CLEARWAY_HD std::uint32_t slot(std::uint32_t lane) const {
    return block_ * kBlockPoints + first_ + lane;
  }

  CLEARWAY_HD void hit(std::uint32_t lane, std::uint32_t pose) {
    if (pose < best_[lane]) best_[lane] = pose;
    if (job_.sweep.first_pose) return;
    ways_[lane].leave_all();
    wanted_[lane] = false;
  }

  CLEARWAY_HD void step(std::uint32_t lane, SweepWay& way) {
    const MotionNode& node = job_.sweep.motion.nodes[way.at];
    const std::uint32_t size = 2 * node.count - 1;
    if (node.first >= best_[lane]) {
      way.at += size;
      return;
    }
    ++statistics_[lane].point_tests;
    const SweepRef::Verdict verdict = job_.sweep.look(points_[lane], node);
    if (verdict == SweepRef::Verdict::kOpen && node.count == 1) {
      way.waits = true;
      return;
    }
    way.at += verdict == SweepRef::Verdict::kDismissed ? size : 1;
    if (verdict == SweepRef::Verdict::kHitAtMid) hit(lane, node.mid);
  }

  /// All lanes that wait, or none.
  CLEARWAY_HD bool deferred(std::uint32_t waiting) {
    const SweepWork& work = job_.work;
    const auto room =
        SweepWork::room<Warp>(&work.counts->items, count_of(waiting), work.item_capacity);
    Warp::each([&](std::uint32_t lane) {
      const std::uint32_t rank = count_of(waiting & ((1U << lane) - 1));
      if ((waiting >> lane & 1) == 0 || rank >= room.written()) return;
      work.items[room.first + rank] = {room.fits() ? slot(lane) : SweepWork::kNone, ways_[lane].at};
    });
    return room.fits();
  }

  CLEARWAY_HD void mark() {
    const std::uint32_t hits = Warp::ballot([&](std::uint32_t lane) {
      if (best_[lane] == SweepPage::kNever) return false;
      if (job_.sweep.first_pose) lower_to(job_.first_poses + slot(lane), best_[lane]);
      return true;
    });
    Warp::each([&](std::uint32_t lane) {
      if (lane == 0 && hits != 0) or_into(job_.hits + block_, std::uint64_t{hits} << first_);
    });
  }

  const SweepPage& job_;
  std::uint32_t block_;
  std::uint32_t first_;  ///< point of the block
  const PageCell& cell_;
  PerLane<SweepStatistics>& statistics_;
  PerLane<SweepWay> ways_;
  PerLane<Vec3> points_;
  PerLane<bool> wanted_;         ///< has something to find
  PerLane<std::uint32_t> best_;  ///< first pose known; without first poses any, as a mark
};

/// The second step: puts the points of a half block to the runs of poses of an entry.
template <typename Warp>
CLEARWAY_HD void search_entry(const SweepPage& job, const SweepWork::Entry& entry,
                              typename Warp::template PerLane<SweepStatistics>& statistics) {
  if (entry.half == SweepWork::kNone) return;
  const PageCell& cell = job.cell_of_block(entry.half / SweepHits<Warp>::kHalves);
  const bool whole = entry.node_count == SweepWork::kWhole;
  const std::uint32_t* nodes = whole ? job.page.nodes(cell) : job.work.nodes + entry.first_node;
  std::uint32_t left = whole ? cell.node_count : entry.node_count;
  while (left > 0) {
    const std::uint32_t count = left < SweepSubtrees::kMost ? left : SweepSubtrees::kMost;
    SweepHits<Warp>(job, entry.half, statistics).search({nodes, count}, true);
    nodes += count;
    left -= count;
  }
}

/// The third step: searches the model for a point and a single pose.
CLEARWAY_HD inline void search_item(const SweepPage& job, const SweepWork::Item& item,
                                    SweepStatistics& statistics) {
  if (item.point == SweepWork::kNone) return;
  const std::uint32_t block = item.point / kBlockPoints;
  const std::uint32_t bit = item.point % kBlockPoints;
  const MotionNode& node = job.sweep.motion.nodes[item.node];
  const bool known = job.sweep.first_pose ? job.first_poses[item.point] <= node.mid
                                          : (job.hits[block] >> bit & 1) != 0;
  if (known) return;
  ++statistics.exact_tests;
  const Vec3 e = job.point(job.cell_of_block(block), job.first_point(block) + bit);
  if (!job.sweep.touches_at(e, node)) return;
  if (job.sweep.first_pose) lower_to(job.first_poses + item.point, node.mid);
  or_into(job.hits + block, std::uint64_t{1} << bit);
}

}  // namespace clearway
