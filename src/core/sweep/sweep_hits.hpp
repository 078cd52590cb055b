#pragma once

#include <cstdint>

#include "core/sweep/sweep_page.hpp"
#include "core/sweep/sweep_walk.hpp"
#include "core/util/device_bits.hpp"

namespace clearway {

/// Marks in the answer of the page which points collide at the poses of some subtrees. One lane for
/// each point. Other warps may work on the same points at the same time.
template <typename Warp, typename Element>
class SweepHits {
 public:
  template <typename Value>
  using PerLane = typename Warp::template PerLane<Value>;

  CLEARWAY_HD SweepHits(const SweepPageOf<Element>& job, PerLane<SweepStatistics>& statistics)
      : job_(job), statistics_(statistics) {}

  /// Searches the 32 points of a half block at the same subtrees: first their tops, then what is
  /// open. defer: puts open work on the page's lists while there is room.
  CLEARWAY_HD void search_half(std::uint32_t half, const SweepSubtrees& subtrees, bool defer) {
    defer_ = defer;
    const std::uint32_t first = half * kWarpLanes;
    const std::uint64_t points = job_.searched(first / kBlockPoints) >> (first % kBlockPoints);
    if (static_cast<std::uint32_t>(points) == 0) return;
    Warp::each([&](std::uint32_t lane) { load(lane, first + lane); });
    look_at_tops<Warp>(
        subtrees, ways_, [&](std::uint32_t lane) { return wanted_[lane]; },
        [&](std::uint32_t lane, std::uint32_t at) { return look_at_top(lane, at); });
    if (!defer || !put_walks_on_list(subtrees)) walk_on(subtrees);
    const std::uint32_t hits = Warp::ballot([&](std::uint32_t lane) {
      if (best_[lane] == kSweepNever) return false;
      if (job_.sweep.first_pose) lower_to(job_.first_poses + slot_[lane], best_[lane]);
      return true;
    });
    Warp::each([&](std::uint32_t lane) {
      if (lane != 0 || hits == 0) return;
      or_into(job_.hits + first / kBlockPoints, std::uint64_t{hits} << (first % kBlockPoints));
    });
  }

  /// Searches walks of the page's list, from `first` on, one by each lane.
  CLEARWAY_HD void search_walks(std::uint32_t first, std::uint32_t count) {
    defer_ = true;
    Warp::each([&](std::uint32_t lane) {
      const SweepWork::Item item = first + lane < count ? job_.work.walks[first + lane]
                                                        : SweepWork::Item{SweepWork::kNone, 0};
      load(lane, item.point);
      if (wanted_[lane]) ways_[lane].enter_below(job_.sweep.motion, item.node);
    });
    walk_on({nullptr, 0});
    Warp::each([&](std::uint32_t lane) {
      if (best_[lane] == kSweepNever) return;
      if (job_.sweep.first_pose) lower_to(job_.first_poses + slot_[lane], best_[lane]);
      or_into(job_.hits + slot_[lane] / kBlockPoints,
              std::uint64_t{1} << (slot_[lane] % kBlockPoints));
    });
  }

 private:
  /// Loads the point in a slot of the page, unless nothing is left to find for it.
  CLEARWAY_HD void load(std::uint32_t lane, std::uint32_t slot) {
    slot_[lane] = slot;
    best_[lane] = kSweepNever;
    wanted_[lane] = false;
    if (slot == SweepWork::kNone) return;
    const std::uint32_t block = slot / kBlockPoints;
    if (!job_.is_searched(block, slot % kBlockPoints)) return;
    if (job_.sweep.first_pose) {
      best_[lane] = job_.first_poses[slot];
    } else if ((job_.hits[block] >> (slot % kBlockPoints) & 1) != 0) {
      return;
    }
    wanted_[lane] = true;
    ++statistics_[lane].points_tested;
    points_[lane] =
        job_.point(job_.cell_of_block(block), job_.first_point(block) + slot % kBlockPoints);
  }

  CLEARWAY_HD void hit(std::uint32_t lane, std::uint32_t pose) {
    if (pose < best_[lane]) best_[lane] = pose;
    if (job_.sweep.first_pose) return;
    ways_[lane].leave_all();
    wanted_[lane] = false;
  }

  /// Looks at the top of a subtree. Returns whether the subtree stays open.
  CLEARWAY_HD bool look_at_top(std::uint32_t lane, std::uint32_t at) {
    const MotionNode& node = job_.sweep.motion.nodes[at];
    if (node.first >= best_[lane]) return false;
    const SweepVerdict verdict = job_.sweep.look(points_[lane], node, statistics_[lane]);
    if (verdict == SweepVerdict::kDismissed) return false;
    if (verdict == SweepVerdict::kOpen) return true;
    hit(lane, job_.sweep.first_pose_of_hit(node.mid));
    return job_.sweep.first_pose && node.first < best_[lane];
  }

  CLEARWAY_HD void walk_on(const SweepSubtrees& subtrees) {
    walk<Warp>(
        job_.sweep.motion, subtrees, ways_,
        [&](std::uint32_t lane, SweepWay& way) { step(lane, way); },
        [&](std::uint32_t waiting) { return defer_ && put_items_on_list(waiting); },
        [&](std::uint32_t lane, std::uint32_t at) {
          ++statistics_[lane].exact_tests;
          const MotionNode& node = job_.sweep.motion.nodes[at];
          if (job_.sweep.collides_at(points_[lane], node)) hit(lane, node.mid);
        });
  }

  CLEARWAY_HD void step(std::uint32_t lane, SweepWay& way) {
    const MotionNode& node = job_.sweep.motion.nodes[way.at];
    const std::uint32_t size = 2 * node.count - 1;
    if (node.first >= best_[lane]) {
      way.at += size;
      return;
    }
    const SweepVerdict verdict = job_.sweep.look(points_[lane], node, statistics_[lane]);
    if (verdict == SweepVerdict::kOpen && node.count == 1) {
      way.waits = true;
      return;
    }
    way.at += verdict == SweepVerdict::kDismissed ? size : 1;
    if (verdict == SweepVerdict::kHitAtMid) {
      hit(lane, job_.sweep.first_pose_of_hit(node.mid));
    }
  }

  /// Puts the open subtrees of all lanes on the page's list, or none of them if there is no room.
  /// Returns whether there was.
  CLEARWAY_HD bool put_walks_on_list(const SweepSubtrees& subtrees) {
    const SweepWork& work = job_.work;
    PerLane<std::uint32_t> before;
    Warp::each([&](std::uint32_t lane) { before[lane] = count_of(ways_[lane].open); });
    const std::uint32_t count = Warp::sum_before(before);
    if (count == 0) return true;
    const auto room = SweepWork::room<Warp>(&work.counts->walks, count, work.walk_capacity);
    Warp::each([&](std::uint32_t lane) {
      if (!room.fits()) {
        for (std::uint32_t i = lane; i < room.written(); i += kWarpLanes) {
          work.walks[room.first + i] = {SweepWork::kNone, 0};
        }
        return;
      }
      std::uint64_t& open = ways_[lane].open;
      for (std::uint32_t i = room.first + before[lane]; open != 0; open &= open - 1) {
        work.walks[i++] = {slot_[lane], subtrees.nodes[lowest_bit(open)]};
      }
    });
    return room.fits();
  }

  /// Puts the single poses of all waiting lanes on the page's list, or none if there is no room.
  /// Returns whether there was.
  CLEARWAY_HD bool put_items_on_list(std::uint32_t waiting) {
    const SweepWork& work = job_.work;
    const auto room =
        SweepWork::room<Warp>(&work.counts->items, count_of(waiting), work.item_capacity);
    Warp::each([&](std::uint32_t lane) {
      const std::uint32_t rank = count_of(waiting & ((1U << lane) - 1));
      if ((waiting >> lane & 1) == 0 || rank >= room.written()) return;
      work.items[room.first + rank] = {room.fits() ? slot_[lane] : SweepWork::kNone,
                                       ways_[lane].at};
    });
    return room.fits();
  }

  const SweepPageOf<Element>& job_;
  PerLane<SweepStatistics>& statistics_;
  PerLane<SweepWay> ways_;
  PerLane<Vec3> points_;
  PerLane<std::uint32_t> slot_;  ///< slot of the lane's point, within the page
  PerLane<std::uint32_t> best_;  ///< first pose known; without first poses any pose, as a mark
  PerLane<bool> wanted_;         ///< whether there is something left to find
  bool defer_ = false;
};

/// Second step of a page: tests the points of a half block at the runs of poses of an entry.
template <typename Warp, typename Element>
CLEARWAY_HD void search_entry(const SweepPageOf<Element>& job, const SweepWork::Entry& entry,
                              typename Warp::template PerLane<SweepStatistics>& statistics) {
  if (entry.half == SweepWork::kNone) return;
  const PageCell& cell = job.cell_of_block(entry.half / SweepWork::kHalves);
  const bool whole = entry.node_count == SweepWork::kWhole;
  const std::uint32_t* nodes = whole ? job.page.nodes(cell) : job.work.nodes + entry.first_node;
  std::uint32_t left = whole ? cell.node_count : entry.node_count;
  while (left > 0) {
    const std::uint32_t count = left < SweepSubtrees::kMost ? left : SweepSubtrees::kMost;
    SweepHits<Warp, Element>(job, statistics).search_half(entry.half, {nodes, count}, true);
    nodes += count;
    left -= count;
  }
}

/// Last step of a page, after the walks: searches the model for a point and a single pose.
template <typename Element>
CLEARWAY_HD void search_item(const SweepPageOf<Element>& job, const SweepWork::Item& item,
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
  if (!job.sweep.collides_at(e, node)) return;
  if (job.sweep.first_pose) lower_to(job.first_poses + item.point, node.mid);
  or_into(job.hits + block, std::uint64_t{1} << bit);
}

}  // namespace clearway
