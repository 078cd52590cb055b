#pragma once

#include <cmath>
#include <cstdint>

#include "core/clearance_set.hpp"
#include "core/hit_set.hpp"
#include "core/page.hpp"
#include "core/sweep_ref.hpp"
#include "gpu/warp.hpp"

namespace clearway {

/// Where the answers for a page go, cell after cell; null for what is not asked for.
struct SweepAnswerRef {
  std::uint64_t* hits;         ///< a word a block
  std::uint32_t* first_poses;  ///< 64 a block
  Clearance* clearances;       ///< likewise
};

/// The search of one block of 64 points by one warp, on a GPU or as a loop: first the motion nodes
/// that may touch the block, a lane a node, then its points, a lane a point. Every lane goes
/// through its subtrees in preorder, where a node's subtree is a run, so that no stack is needed;
/// lanes that need a search of the model wait for each other.
/// kClearance: whether the question asks for clearances.
template <typename Warp, bool kClearance>
class SweepBlock {
 public:
  /// Open nodes are kept in `queue`, kQueue of them, shared by the lanes.
  static constexpr std::uint32_t kQueue = 64;

  /// cell, block: within the page; the block has points or lies past them.
  CLEARWAY_HD SweepBlock(const SweepRef& sweep, const PageRef& page,
                         const Quantisation& quantisation, std::uint32_t cell, std::uint32_t block,
                         const SweepAnswerRef& answer, std::uint32_t* queue)
      : sweep_(sweep),
        page_(page),
        quantisation_(quantisation),
        cell_(page.cell(cell)),
        block_(block),
        word_(std::uint64_t{cell} * page.shape.blocks_per_cell + block),
        answer_(answer),
        queue_(queue) {
    begin_answer();
    if (block * kBlockPoints >= cell_.count) return;
    const Box box =
        position_box(quantisation, decode_block_box(cell_.box, page.blocks(cell)[block]));
    narrow(centre_of(box), half_diagonal(box), page.nodes(cell_));
  }

  /// Of the lane.
  CLEARWAY_HD const SweepStatistics& statistics(std::uint32_t lane) { return statistics_[lane]; }

 private:
  using Verdict = SweepRef::Verdict;
  template <typename Value>
  using PerLane = typename Warp::template PerLane<Value>;

  /// A lane's way through subtrees of the motion tree.
  struct Way {
    std::uint32_t at = 0, end = 0;  ///< the node to look at, and the first behind the subtree
    std::uint32_t queued = 0;       ///< subtrees of the queue that were entered
    bool waits = false;             ///< for a search of the model at the single pose `at`
  };

  /// One more than the last node of the subtree of node `index`.
  CLEARWAY_HD std::uint32_t behind(std::uint32_t index) const {
    return index + 2 * sweep_.motion.nodes[index].count - 1;
  }

  CLEARWAY_HD void begin_answer() {
    Warp::each([&](std::uint32_t lane) {
      if (lane == 0) answer_.hits[word_] = 0;
      for (std::uint32_t i = lane; i < kBlockPoints; i += kWarpLanes) {
        const std::uint64_t slot = word_ * kBlockPoints + i;
        if (answer_.first_poses != nullptr) answer_.first_poses[slot] = kNever;
        if (kClearance) answer_.clearances[slot] = Clearance{kInfinity, kNever};
      }
    });
  }

  CLEARWAY_HD void narrow(const Vec3& centre, double rho, const std::uint32_t* nodes) {
    double limit = sweep_.radius;
    if constexpr (kClearance) limit = clearance_limit(centre, rho, nodes);
    PerLane<Way> ways;
    PerLane<std::uint32_t> kept;
    for (std::uint32_t next = 0;;) {  // of `nodes`
      const std::uint32_t open =
          Warp::ballot([&](std::uint32_t lane) { return ways[lane].at != ways[lane].end; });
      const bool done = open == 0 && next >= cell_.node_count;
      if (queued_ > kQueue - kWarpLanes || (done && queued_ > 0)) search_points();
      if (done) return;
      if (open == 0) {
        Warp::each([&](std::uint32_t lane) {
          if (next + lane >= cell_.node_count) return;
          ways[lane].at = nodes[next + lane];
          ways[lane].end = behind(ways[lane].at);
        });
        next += kWarpLanes;
      }
      const std::uint32_t keep = Warp::ballot([&](std::uint32_t lane) {
        return narrow_step(ways[lane], centre, rho, limit, kept[lane], statistics_[lane]);
      });
      Warp::each([&](std::uint32_t lane) {
        if ((keep >> lane & 1) == 0) return;
        queue_[queued_ + count_of(keep & ((1U << lane) - 1))] = kept[lane];
      });
      queued_ += count_of(keep);
    }
  }

  /// Whether the node looked at is to be kept for the points.
  CLEARWAY_HD bool narrow_step(Way& way, const Vec3& centre, double rho, double limit,
                               std::uint32_t& kept, SweepStatistics& statistics) const {
    if (way.at == way.end) return false;
    ++statistics.node_tests;
    const MotionNode& node = sweep_.motion.nodes[way.at];
    const SweepRef::Fate fate = sweep_.fate_of(node, centre, rho, limit);
    kept = way.at;
    way.at += fate == SweepRef::Fate::kSplit ? 1 : 2 * node.count - 1;
    return fate == SweepRef::Fate::kKept;
  }

  CLEARWAY_HD double clearance_limit(const Vec3& centre, double rho, const std::uint32_t* nodes) {
    PerLane<double> limits;
    Warp::each([&](std::uint32_t lane) {
      limits[lane] = kInfinity;
      for (std::uint32_t i = lane; i < cell_.node_count; i += kWarpLanes) {
        const double limit = sweep_.clearance_limit(centre, rho, nodes + i, 1, statistics_[lane]);
        if (limit < limits[lane]) limits[lane] = limit;
      }
    });
    return Warp::least(limits);
  }

  /// Puts the points to the nodes in the queue, and empties it.
  CLEARWAY_HD void search_points() {
    const bool clearances_decide = kClearance && sweep_.hits_follow_from_clearance();
    for (std::uint32_t half = 0; half < kBlockPoints / kWarpLanes; ++half) {
      const std::uint32_t first = block_ * kBlockPoints + half * kWarpLanes;
      if (first >= cell_.count) break;
      PerLane<Vec3> points;
      Warp::each([&](std::uint32_t lane) {
        if (first + lane < cell_.count) points[lane] = point(first + lane);
      });
      std::uint32_t hits = clearances_decide ? 0 : search_hits(points, half);
      if constexpr (kClearance) hits |= search_clearances(points, half);
      Warp::each([&](std::uint32_t lane) {
        if (lane == 0) answer_.hits[word_] |= std::uint64_t{hits} << (half * kWarpLanes);
      });
    }
    queued_ = 0;
  }

  CLEARWAY_HD Vec3 point(std::uint32_t index) const {
    return position(quantisation_, page_.value(cell_.chunks[0], index),
                    page_.value(cell_.chunks[1], index), page_.value(cell_.chunks[2], index));
  }

  CLEARWAY_HD std::uint32_t point_count(std::uint32_t half) const {
    return cell_.count - block_ * kBlockPoints - half * kWarpLanes;
  }

  CLEARWAY_HD std::uint64_t slot_of(std::uint32_t half, std::uint32_t lane) const {
    return word_ * kBlockPoints + half * kWarpLanes + lane;
  }

  /// Enters the next subtree of the queue where the last one is done; false at the end.
  CLEARWAY_HD bool enter(Way& way) const {
    if (way.at != way.end) return true;
    if (way.queued == queued_) return false;
    way.at = queue_[way.queued++];
    way.end = behind(way.at);
    return true;
  }

  /// The lanes' ways to their ends: step(lane, way) looks at a node and moves the way on or lets it
  /// wait, search(lane, way) searches the model at a single pose and moves it on.
  template <typename Step, typename Search>
  CLEARWAY_HD void follow(PerLane<Way>& ways, Step step, Search search) {
    for (;;) {
      std::uint32_t walking;
      do {
        walking = Warp::ballot([&](std::uint32_t lane) {
          Way& way = ways[lane];
          if (way.waits || !enter(way)) return false;
          step(lane, way);
          return true;
        });
      } while (walking != 0);
      const std::uint32_t waiting =
          Warp::ballot([&](std::uint32_t lane) { return ways[lane].waits; });
      if (waiting == 0) return;
      Warp::each([&](std::uint32_t lane) {
        Way& way = ways[lane];
        if (!way.waits) return;
        way.waits = false;
        ++statistics_[lane].exact_tests;
        search(lane, way);
      });
    }
  }

  CLEARWAY_HD static void finish(Way& way, std::uint32_t queued) {
    way.at = way.end = 0;
    way.queued = queued;
  }

  /// The points that collide, as bits; first poses go to the answer.
  CLEARWAY_HD std::uint32_t search_hits(PerLane<Vec3>& points, std::uint32_t half) {
    PerLane<Way> ways;
    PerLane<std::uint32_t> best;  // the first pose known, or any as a mark without first poses
    const std::uint64_t known = answer_.hits[word_] >> (half * kWarpLanes);
    Warp::each([&](std::uint32_t lane) {
      best[lane] = kNever;
      if (lane >= point_count(half)) return finish(ways[lane], queued_);
      if (sweep_.first_pose) best[lane] = answer_.first_poses[slot_of(half, lane)];
      if (!sweep_.first_pose && (known >> lane & 1) != 0) return finish(ways[lane], queued_);
      ++statistics_[lane].points_tested;
    });
    const auto hit = [&](std::uint32_t lane, std::uint32_t pose) {
      if (pose < best[lane]) best[lane] = pose;
      if (!sweep_.first_pose) finish(ways[lane], queued_);
    };
    follow(
        ways,
        [&](std::uint32_t lane, Way& way) {
          const MotionNode& node = sweep_.motion.nodes[way.at];
          const std::uint32_t size = 2 * node.count - 1;
          if (node.first >= best[lane]) {
            way.at += size;
            return;
          }
          ++statistics_[lane].point_tests;
          double squared_lower;
          const Verdict verdict = sweep_.look(points[lane], node, squared_lower);
          if (verdict == Verdict::kOpen && node.count == 1) {
            way.waits = true;
            return;
          }
          way.at += verdict == Verdict::kDismissed ? size : 1;
          if (verdict == Verdict::kHitAtMid) hit(lane, node.mid);
        },
        [&](std::uint32_t lane, Way& way) {
          const MotionNode& node = sweep_.motion.nodes[way.at++];
          if (sweep_.touches_at(points[lane], node)) hit(lane, node.mid);
        });
    if (sweep_.first_pose) {
      Warp::each([&](std::uint32_t lane) {
        if (best[lane] != kNever) answer_.first_poses[slot_of(half, lane)] = best[lane];
      });
    }
    return Warp::ballot([&](std::uint32_t lane) { return best[lane] != kNever; });
  }

  /// Clearances of the points, to the answer. Returns those closer than the radius, where they are
  /// the points that collide.
  CLEARWAY_HD std::uint32_t search_clearances(PerLane<Vec3>& points, std::uint32_t half) {
    const double limit = rounded_product(sweep_.clearance, sweep_.clearance);
    PerLane<Way> ways;
    PerLane<Clearance> best;
    Warp::each([&](std::uint32_t lane) {
      best[lane] = Clearance{limit, 0};  // pose 0, so that a tie with the limit is no improvement
      if (lane >= point_count(half)) return finish(ways[lane], queued_);
      ++statistics_[lane].points_tested;
      const Clearance known = answer_.clearances[slot_of(half, lane)];
      if (known.squared < limit) best[lane] = known;
    });
    const auto offer = [&](std::uint32_t lane, std::uint32_t pose, const Vec3& m) {
      const double squared =
          squared_distance(points[lane], transform(sweep_.motion.poses[pose], m));
      Clearance& known = best[lane];
      if (squared < known.squared || (squared == known.squared && pose < known.pose)) {
        known = Clearance{squared, pose};
      }
    };
    const auto reach = [&](std::uint32_t lane) {
      return std::sqrt(best[lane].squared) * kRoundedUp + sweep_.rounding;
    };
    follow(
        ways,
        [&](std::uint32_t lane, Way& way) {
          ++statistics_[lane].point_tests;
          const MotionNode& node = sweep_.motion.nodes[way.at];
          const PullBack& back = sweep_.motion.pull_backs[node.mid];
          const ModelFieldRef::Bounds bounds = sweep_.field.bounds(back.apply(points[lane]));
          if (farther(back.least, bounds.squared_lower, reach(lane) + node.delta)) {
            way.at += 2 * node.count - 1;
            return;
          }
          if (bounds.near != ModelFieldRef::kNone) {
            offer(lane, node.mid, sweep_.model.points[bounds.near]);
          }
          if (node.count == 1) {
            way.waits = true;
          } else {
            ++way.at;
          }
        },
        [&](std::uint32_t lane, Way& way) {
          search_pose(
              points[lane], sweep_.motion.nodes[way.at++].mid, [&] { return reach(lane); },
              [&](std::uint32_t pose, const Vec3& m) { offer(lane, pose, m); });
        });
    Warp::each([&](std::uint32_t lane) {
      if (best[lane].squared < limit) answer_.clearances[slot_of(half, lane)] = best[lane];
    });
    const double touching = rounded_product(sweep_.radius, sweep_.radius);
    const std::uint32_t closer = Warp::ballot([&](std::uint32_t lane) {
      return best[lane].squared < limit && best[lane].squared < touching;
    });
    return sweep_.hits_follow_from_clearance() ? closer : 0;
  }

  /// Offers every model point that may have the least d2 at one pose.
  template <typename Reach, typename Offer>
  CLEARWAY_HD void search_pose(const Vec3& e, std::uint32_t pose, Reach reach, Offer offer) const {
    const PullBack& back = sweep_.motion.pull_backs[pose];
    const Vec3 x = back.apply(e);
    const std::uint32_t near = sweep_.field.bounds(x).near;
    const ModelTreeRef::Nearest nearest =
        sweep_.model.nearest(x, near == ModelFieldRef::kNone ? 0 : near);
    if (farther(back.least, nearest.squared_distance, reach())) return;
    offer(pose, sweep_.model.points[nearest.point]);
    const double ball = reach() / back.least * kRoundedUp;
    sweep_.model.any_within(x, ball * ball * kRoundedUp, [&](const Vec3& m) {
      offer(pose, m);
      return false;
    });
  }

  static constexpr std::uint32_t kNever = 0xffffffff;

  const SweepRef& sweep_;
  const PageRef& page_;
  const Quantisation& quantisation_;
  const PageCell& cell_;
  std::uint32_t block_;
  std::uint64_t word_;
  const SweepAnswerRef& answer_;
  std::uint32_t* queue_;
  std::uint32_t queued_ = 0;
  PerLane<SweepStatistics> statistics_;
};

}  // namespace clearway
