#pragma once

#include <cstdint>

#include "core/sweep/point_clearance.hpp"
#include "core/sweep/sweep_page.hpp"
#include "core/sweep/sweep_walk.hpp"

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

}  // namespace clearway
