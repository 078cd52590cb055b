#pragma once

#include <cstdint>

#include "core/sweep/point_clearance.hpp"
#include "core/sweep/sweep_hits.hpp"
#include "core/sweep/sweep_page.hpp"
#include "core/sweep/sweep_walk.hpp"
#include "core/util/device_bits.hpp"

namespace clearway {

/// Improves the clearances of the 32 points of a half block, in the answer of the page, over the
/// poses of some subtrees. One lane for each point; no other warp works on the same points.
template <typename Warp, typename Element>
class SweepClearances {
 public:
  template <typename Value>
  using PerLane = typename Warp::template PerLane<Value>;

  CLEARWAY_HD SweepClearances(const SweepPageOf<Element>& job, std::uint32_t half,
                              PerLane<SweepStatistics>& statistics)
      : job_(job),
        block_(half / SweepWork::kHalves),
        first_(half % SweepWork::kHalves * kWarpLanes),
        cell_(job.cell_of_block(block_)),
        statistics_(statistics) {}

  CLEARWAY_HD void search(const SweepSubtrees& subtrees) {
    const std::uint32_t begin = job_.first_point(block_) + first_;
    const double limit = rounded_product(job_.sweep.clearance, job_.sweep.clearance);
    const double touching = rounded_product(job_.sweep.radius, job_.sweep.radius);
    const std::uint32_t closer = Warp::ballot([&](std::uint32_t lane) {
      if (!job_.is_searched(block_, first_ + lane)) return false;
      ++statistics_[lane].points_tested;
      Clearance& answer = job_.clearances[block_ * kBlockPoints + first_ + lane];
      // Pose 0, so that a distance equal to the limit is not an improvement.
      const Clearance best = answer.squared < limit ? answer : Clearance{limit, 0};
      PointClearance<Element> search(job_.sweep, job_.point(cell_, begin + lane), best,
                                     statistics_[lane]);
      search.search(subtrees.nodes, subtrees.count);
      if (!(search.best().squared < limit)) return false;
      answer = search.best();
      return answer.squared < touching;
    });
    if (!job_.sweep.hits_follow_from_clearance()) return;
    Warp::each([&](std::uint32_t lane) {
      if (lane == 0) job_.hits[block_] |= std::uint64_t{closer} << first_;
    });
  }

 private:
  const SweepPageOf<Element>& job_;
  std::uint32_t block_;
  std::uint32_t first_;  ///< first point of the half, in the block
  const PageCell& cell_;
  PerLane<SweepStatistics>& statistics_;
};

/// First step of a page for one block of 64 points, by one warp. It clears the block's answer, goes
/// through the planned motion nodes, one by each lane, and puts those that may touch the block on
/// the page's list of entries or, if that is full, the block as a whole. With clearances the points
/// are searched at once, because only one warp may improve theirs.
template <typename Warp, bool kClearance, typename Element = Vec3>
class SweepBlock {
 public:
  template <typename Value>
  using PerLane = typename Warp::template PerLane<Value>;

  static constexpr std::uint32_t kQueue = SweepSubtrees::kMost;
  static constexpr std::uint32_t kOpen = 96;

  /// The memory that the lanes share.
  struct Shared {
    std::uint32_t open[kOpen];     ///< nodes to be looked at
    std::uint32_t queue[kQueue];   ///< nodes at which points are to be searched
    std::uint32_t sorted[kQueue];  ///< the queue in the order of the poses, for clearances
    std::uint32_t joined;          ///< number of sorted nodes after joining them
  };

  CLEARWAY_HD SweepBlock(const SweepPageOf<Element>& job, std::uint32_t block, Shared& shared,
                         PerLane<SweepStatistics>& statistics)
      : job_(job),
        block_(block),
        cell_(job.cell_of_block(block)),
        shared_(shared),
        statistics_(statistics) {}

  CLEARWAY_HD void search() {
    clear_result();
    if (job_.searched(block_) == 0) return;
    const std::uint32_t per_cell = job_.page.shape.blocks_per_cell;
    const BlockBox& code = job_.page.blocks(block_ / per_cell)[block_ % per_cell];
    const Box box = position_box(job_.quantisation, decode_block_box(cell_.box, code));
    narrow(PointBox(box), job_.page.nodes(cell_));
  }

 private:
  CLEARWAY_HD void clear_result() {
    Warp::each([&](std::uint32_t lane) {
      if (lane == 0) job_.hits[block_] = 0;
      for (std::uint32_t i = lane; i < kBlockPoints; i += kWarpLanes) {
        const std::uint32_t slot = block_ * kBlockPoints + i;
        if (job_.first_poses != nullptr) job_.first_poses[slot] = kSweepNever;
        if (kClearance) job_.clearances[slot] = Clearance{kInfinity, kSweepNever};
      }
    });
  }

  CLEARWAY_HD void narrow(const PointBox& points, const std::uint32_t* nodes) {
    double limit = job_.sweep.radius;
    if constexpr (kClearance) limit = clearance_limit(points.centre, points.rho, nodes);
    for (std::uint32_t next = 0;;) {  // next: index in `nodes`
      const bool done = open_ == 0 && next >= cell_.node_count;
      if (queued_ > kQueue - kWarpLanes || (done && queued_ > 0)) empty_queue();
      if (done || is_whole_) return;
      if (open_ == 0) next = open_planned(nodes, next);
      if (narrow_open(points, limit)) return mark_all();
    }
  }

  /// Opens the next planned nodes. Returns how many were opened so far.
  CLEARWAY_HD std::uint32_t open_planned(const std::uint32_t* nodes, std::uint32_t next) {
    const std::uint32_t left = cell_.node_count - next;
    open_ = left < kWarpLanes ? left : kWarpLanes;
    Warp::each([&](std::uint32_t lane) {
      if (lane < open_) shared_.open[lane] = nodes[next + lane];
    });
    return next + open_;
  }

  /// Looks at the last open nodes, one by each lane. Nodes that are fine enough go to the queue,
  /// and the others leave their halves open; without room for the halves a node counts as fine
  /// enough. Returns true if the whole block is accepted.
  CLEARWAY_HD bool narrow_open(const PointBox& points, double limit) {
    const std::uint32_t count = open_ < kWarpLanes ? open_ : kWarpLanes;
    open_ -= count;
    const bool has_room = open_ + 2 * count <= kOpen;
    PerLane<std::uint32_t> at;
    PerLane<SweepBoxClass> fate;
    Warp::each([&](std::uint32_t lane) {
      fate[lane] = SweepBoxClass::kDismissed;
      if (lane >= count) return;
      ++statistics_[lane].node_tests;
      at[lane] = shared_.open[open_ + lane];
      const MotionNode& node = job_.sweep.motion.nodes[at[lane]];
      fate[lane] = job_.sweep.classify_box(node, points, limit, job_.sweep.accepts_boxes());
      if (fate[lane] == SweepBoxClass::kSplit && !has_room) fate[lane] = SweepBoxClass::kKept;
    });
    const std::uint32_t accepted =
        Warp::ballot([&](std::uint32_t lane) { return fate[lane] == SweepBoxClass::kAccepted; });
    if (accepted != 0) return true;
    const std::uint32_t keep =
        Warp::ballot([&](std::uint32_t lane) { return fate[lane] == SweepBoxClass::kKept; });
    const std::uint32_t split =
        Warp::ballot([&](std::uint32_t lane) { return fate[lane] == SweepBoxClass::kSplit; });
    Warp::each([&](std::uint32_t lane) {
      const std::uint32_t before = (1U << lane) - 1;
      if ((keep >> lane & 1) != 0) shared_.queue[queued_ + count_of(keep & before)] = at[lane];
      if ((split >> lane & 1) == 0) return;
      std::uint32_t* halves = shared_.open + open_ + 2 * count_of(split & before);
      halves[0] = job_.sweep.motion.nodes[at[lane]].later;
      halves[1] = at[lane] + 1;
    });
    queued_ += count_of(keep);
    open_ += 2 * count_of(split);
    return false;
  }

  CLEARWAY_HD void mark_all() {
    Warp::each([&](std::uint32_t lane) {
      if (lane == 0) job_.hits[block_] = job_.searched(block_);
    });
  }

  CLEARWAY_HD double clearance_limit(const Vec3& centre, double rho, const std::uint32_t* nodes) {
    PerLane<double> limits;
    Warp::each([&](std::uint32_t lane) {
      limits[lane] = kInfinity;
      for (std::uint32_t i = lane; i < cell_.node_count; i += kWarpLanes) {
        const double limit =
            job_.sweep.clearance_limit(centre, rho, nodes + i, 1, statistics_[lane]);
        if (limit < limits[lane]) limits[lane] = limit;
      }
    });
    return Warp::least(limits);
  }

  CLEARWAY_HD std::uint32_t halves() const {
    return job_.searched(block_) >> kWarpLanes != 0 ? 2 : 1;
  }

  CLEARWAY_HD void empty_queue() {
    if constexpr (kClearance) {
      search_points();
    } else {
      is_whole_ = !put_on_list();
      if (is_whole_) put_whole_on_list();
    }
    queued_ = 0;
  }

  CLEARWAY_HD void search_points() {
    const std::uint32_t first = SweepWork::kHalves * block_;
    for (std::uint32_t i = 0; i < halves(); ++i) {
      if (job_.sweep.hits_follow_from_clearance()) break;
      SweepHits<Warp, Element>(job_, statistics_)
          .search_half(first + i, {shared_.queue, queued_}, false);
    }
    sort_queue();
    Warp::each([&](std::uint32_t lane) {
      if (lane == 0) shared_.joined = job_.sweep.motion.join_smooth(shared_.sorted, queued_);
    });
    for (std::uint32_t i = 0; i < halves(); ++i) {
      SweepClearances<Warp, Element>(job_, first + i, statistics_)
          .search({shared_.sorted, shared_.joined});
    }
  }

  /// Puts the queue in the order of the poses, which is that of the nodes' numbers because no node
  /// holds another one. Nodes come to the queue with later halves first, and those that are not in
  /// order are never joined.
  CLEARWAY_HD void sort_queue() {
    Warp::each([&](std::uint32_t lane) {
      for (std::uint32_t i = lane; i < queued_; i += kWarpLanes) {
        const std::uint32_t node = shared_.queue[i];
        std::uint32_t before = 0;
        for (std::uint32_t k = 0; k < queued_; ++k) {
          const std::uint32_t other = shared_.queue[k];
          before += other < node || (other == node && k < i) ? 1 : 0;
        }
        shared_.sorted[before] = node;
      }
    });
  }

  /// Puts the whole queue on the page's list, or nothing if there is no room. Returns whether there
  /// was.
  CLEARWAY_HD bool put_on_list() {
    const SweepWork& work = job_.work;
    const auto nodes = SweepWork::room<Warp>(&work.counts->nodes, queued_, work.node_capacity);
    if (!nodes.fits()) return false;
    const auto entries =
        SweepWork::room<Warp>(&work.counts->entries, halves(), work.entry_capacity);
    Warp::each([&](std::uint32_t lane) {
      for (std::uint32_t i = lane; i < queued_; i += kWarpLanes) {
        work.nodes[nodes.first + i] = shared_.queue[i];
      }
      if (lane >= entries.written()) return;
      work.entries[entries.first + lane] = {
          entries.fits() ? SweepWork::kHalves * block_ + lane : SweepWork::kNone, nodes.first,
          queued_};
    });
    return entries.fits();
  }

  /// Lists the block as a whole; its points are then tested at all planned nodes.
  CLEARWAY_HD void put_whole_on_list() {
    const std::uint32_t first = Warp::add(&job_.work.counts->whole, halves(), SweepWork::kNone);
    Warp::each([&](std::uint32_t lane) {
      if (lane >= halves()) return;
      job_.work.entries[job_.work.entry_capacity + first + lane] = {
          SweepWork::kHalves * block_ + lane, 0, SweepWork::kWhole};
    });
  }

  const SweepPageOf<Element>& job_;
  std::uint32_t block_;
  const PageCell& cell_;
  Shared& shared_;
  std::uint32_t open_ = 0, queued_ = 0;  ///< numbers of open and of queued nodes
  bool is_whole_ = false;  ///< whether the block was listed as a whole because the list was full
  PerLane<SweepStatistics>& statistics_;
};

}  // namespace clearway
