#pragma once

#include <cmath>
#include <cstdint>
#include <type_traits>

#include "core/geometry/sweep_bounds.hpp"
#include "core/sweep/profile/profile_blocks.hpp"
#include "core/sweep/profile/profile_depths.hpp"
#include "core/sweep/profile/sweep_profile.hpp"
#include "core/trajectory/motion_tree_ref.hpp"

namespace clearway {

/// Distances beyond which nothing matters any more to poses and motion nodes of a profile.
struct ProfileReaches {
  const MotionTreeRef& motion;
  const ProfileBests& bests;
  double rounding;

  /// A distance for a squared distance: a pose at which no model point is nearer than this has only
  /// d2 above `squared`.
  CLEARWAY_HD double of(double squared) const { return std::sqrt(squared) * kRoundedUp + rounding; }

  CLEARWAY_HD double of_node(std::uint32_t index) const {
    const MotionNode& node = motion.nodes[index];
    return node.count == 1 ? of(greater_of(load_shared(bests.of_pose + node.mid), 0))
                           : load_shared(bests.of_node + index);
  }

  /// Lowers the reach of a motion node. To be called by one lane.
  CLEARWAY_HD void note(std::uint32_t index, double reach) const {
    if (reach < load_shared(bests.of_node + index)) store_shared(bests.of_node + index, reach);
  }

  /// Lowers the reach of a node to the larger reach of its halves. To be called by one lane.
  CLEARWAY_HD void note_halves(std::uint32_t index) const {
    note(index, greater_of(of_node(index + 1), of_node(motion.nodes[index].later)));
  }
};

/// Finds by one warp the points of a cell that are nearest to the model at the poses of motion
/// nodes. It descends the motion tree and carries along which blocks are still open. Blocks and
/// points are given up only if a bound proves every computed d2 to be above the best of each pose,
/// so that ties stay (docs/design/numerics.md, "Profile"). With solids, points inside are searched
/// first. Ties: policy for points with the same d2 (UnresolvedTies or SmallestSource).
template <typename Warp, typename Ties, typename Element>
class ProfileSearch {
 public:
  using Blocks = ProfileBlocks<Warp, Element>;
  template <typename Value>
  using PerLane = typename Warp::template PerLane<Value>;

  /// The memory that the lanes share.
  struct Shared {
    typename Blocks::Shared blocks;
    Vec3 point;       ///< the last point found
    Element element;  ///< the model's element nearest to `point`
  };

  CLEARWAY_HD ProfileSearch(const SweepRefOf<Element>& sweep, const PageRef& page,
                            const Quantisation& quantisation, const ProfileBests& bests,
                            const Ties& ties, Shared& shared, PerLane<SweepStatistics>& statistics)
      : sweep_(sweep),
        page_(page),
        quantisation_(quantisation),
        bests_(bests),
        reaches_{sweep.motion, bests, sweep.rounding},
        ties_(ties),
        shared_(shared),
        statistics_(statistics),
        blocks_(sweep, page, quantisation, shared.blocks, statistics),
        depths_(sweep, page, quantisation, bests, blocks_, ties_, statistics) {}
  ProfileSearch(const ProfileSearch&) = delete;
  ProfileSearch& operator=(const ProfileSearch&) = delete;

  CLEARWAY_HD static std::uint32_t parts_of_cell(std::uint32_t blocks_per_cell) {
    return static_cast<std::uint32_t>(divide_up(blocks_per_cell, Blocks::kPartBlocks));
  }

  /// Begins a part of a cell of the page. Returns whether the part has points.
  CLEARWAY_HD bool enter(std::uint32_t cell, std::uint32_t part) {
    cell_ = &page_.cell(cell);
    index_ = cell;
    first_point_ = part * Blocks::kPartBlocks * kBlockPoints;
    first_slot_ = cell * page_.shape.blocks_per_cell * kBlockPoints + first_point_;
    has_guess_ = was_found_ = false;
    last_pose_ = kSweepNever;
    ties_.enter_cell(cell, *cell_);
    if constexpr (kIsSolid<Element>) depths_.enter(cell, first_point_, first_slot_);
    return blocks_.enter(cell, part);
  }

  /// Searches all poses of a motion node.
  CLEARWAY_HD void search(std::uint32_t top) {
    if constexpr (kIsSolid<Element>) {
      depths_.search(top);
      last_pose_ = kSweepNever;
    }
    const MotionNode* nodes = sweep_.motion.nodes;
    std::uint32_t path[kPathLevels];
    // is_later: one bit for each level, set in the later half
    std::uint32_t level = 0, is_later = 0;
    path[0] = top;
    for (;;) {
      if (descends(path[level], level)) {
        path[level + 1] = path[level] + 1;
        ++level;
        is_later &= ~(1U << level);
        continue;
      }
      for (;; --level) {
        if (level == 0) return;
        if ((is_later >> level & 1) == 0) break;
        Warp::each([&](std::uint32_t lane) {
          if (lane == 0) reaches_.note_halves(path[level - 1]);
        });
      }
      path[level] = nodes[path[level - 1]].later;
      is_later |= 1U << level;
    }
  }

  /// Searches one pose, for which d2 above `bound` do not matter, but those equal to it do.
  CLEARWAY_HD void search_pose(std::uint32_t pose, double bound) {
    bound_ = bound;
    found_ = kInfinity;
    if constexpr (kIsSolid<Element>) {
      if (bound < 0) found_ = depths_.search_pose(pose, 0, bound);
    }
    if (!(bound < 0) && blocks_.look({pose}, 0, reaches_.of(bound))) search_blocks(pose, 1);
    Warp::each([&](std::uint32_t lane) {
      if (lane == 0 && found_ < kInfinity) ties_.keep(pose, found_);
    });
  }

 private:
  /// Levels of the descent; below them, poses are looked at one by one.
  static constexpr std::uint32_t kPathLevels = Blocks::kLevels - 2;

  /// Looks at a node, searches it if it is not divided further, and returns whether its halves are
  /// to be searched.
  CLEARWAY_HD bool descends(std::uint32_t index, std::uint32_t level) {
    const MotionNode& node = sweep_.motion.nodes[index];
    if (node.count == 1) {
      search_single(node.mid, level);
      return false;
    }
    const double known = Warp::once([&] { return load_shared(bests_.of_node + index); });
    if (!blocks_.look(sweep_.around(node), level, known)) return false;
    const double reach = blocks_.reach();
    if (reach < known) {
      Warp::each([&](std::uint32_t lane) {
        if (lane == 0) reaches_.note(index, reach);
      });
    }
    if (level + 1 < kPathLevels) return true;
    for (std::uint32_t i = 0; i < node.count; ++i) search_single(node.first + i, level + 1);
    return false;
  }

  /// Searches a single pose, whose open blocks are those of the level.
  CLEARWAY_HD void search_single(std::uint32_t pose, std::uint32_t level) {
    bound_ = Warp::once([&] { return load_shared(bests_.of_pose + pose); });
    if (kIsSolid<Element> && bound_ < 0) {
      last_pose_ = kSweepNever;
      return;
    }
    if (last_pose_ != kSweepNever && last_pose_ + 1 == pose &&
        sweep_.motion.poses[pose] == sweep_.motion.poses[last_pose_]) {
      last_pose_ = pose;  // the pose repeats the last one, so what was found is the same
      if (was_found_ && found_ <= bound_) keep(pose);
      return;
    }
    last_pose_ = kSweepNever;
    if (has_guess_ && sweep_.counts(shared_.point, pose)) {
      lower_bound(squared_at(pose, shared_.point, shared_.element));
    }
    if (!blocks_.look({pose}, level, reaches_.of(bound_))) return;
    search_blocks(pose, level + 1);
    last_pose_ = pose;
    was_found_ = found_ < kInfinity;
    if (was_found_) keep(pose);
  }

  CLEARWAY_HD void keep(std::uint32_t pose) {
    Warp::each([&](std::uint32_t lane) {
      if (lane != 0) return;
      lower_shared(bests_.of_pose + pose, found_);
      ties_.keep(pose, found_);
    });
  }

  /// Searches the blocks that are open at a level, the nearest first.
  CLEARWAY_HD void search_blocks(std::uint32_t pose, std::uint32_t level) {
    found_ = kInfinity;
    const std::uint32_t first = blocks_.nearest();
    if (first != Blocks::kNone) search_block(pose, first);
    for (std::uint32_t word = 0; word < blocks_.word_count(); ++word) {
      std::uint32_t open = blocks_.still_open(word, level, first);
      for (; open != 0; open &= open - 1) {
        search_block(pose, word * kWarpLanes + lowest_bit(open));
      }
    }
  }

  CLEARWAY_HD void search_block(std::uint32_t pose, std::uint32_t block) {
    for (std::uint32_t begin = block * kBlockPoints; begin < (block + 1) * kBlockPoints;
         begin += kWarpLanes) {
      if (first_point_ + begin < cell_->count) search_points(pose, begin);
    }
  }

  /// Searches 32 points of a block, one by each lane: first against the element that the field
  /// names as near, then, if still open, against the model's tree.
  CLEARWAY_HD void search_points(std::uint32_t pose, std::uint32_t begin) {
    PerLane<Vec3> e;
    PerLane<Element> m;
    PerLane<ModelFieldRef::Bounds> bounds;
    PerLane<double> least;
    std::uint32_t open = Warp::ballot([&](std::uint32_t lane) {
      least[lane] = kInfinity;
      const std::uint32_t index = first_point_ + begin + lane;
      if (!page_.is_searched(index_, index)) return false;
      ++statistics_[lane].point_tests;
      e[lane] = page_.position(quantisation_, *cell_, index);
      bounds[lane] = sweep_.field.bounds(sweep_.motion.inverse_poses[pose].apply(e[lane]));
      if (!blocks_.matters(0, bounds[lane].squared_lower)) return false;
      if (!sweep_.counts(e[lane], pose)) return false;
      if (bounds[lane].near != ModelFieldRef::kNone) {
        offer(pose, e[lane], sweep_.model.elements[bounds[lane].near], least[lane], m[lane]);
      }
      return true;
    });
    if (open == 0) return;
    lower_bound(Warp::least(least));
    open = Warp::ballot([&](std::uint32_t lane) {
      return (open >> lane & 1) != 0 && blocks_.matters(0, bounds[lane].squared_lower);
    });
    Warp::each([&](std::uint32_t lane) {
      if ((open >> lane & 1) == 0) return;
      ++statistics_[lane].exact_tests;
      search_point(pose, e[lane], least[lane], m[lane]);
    });
    take(begin, least, e, m);
  }

  CLEARWAY_HD void lower_bound(double squared) {
    if (!(squared < bound_)) return;
    bound_ = squared;
    blocks_.lower_reach(reaches_.of(bound_));
  }

  CLEARWAY_HD double squared_at(std::uint32_t pose, const Vec3& e, const Element& m) const {
    return squared_distance(e, transform(sweep_.motion.poses[pose], m));
  }

  CLEARWAY_HD bool offer(std::uint32_t pose, const Vec3& e, const Element& m, double& least,
                         Element& near) const {
    const double squared = squared_at(pose, e, m);
    if (!(squared < least)) return false;
    least = squared;
    near = m;
    return true;
  }

  /// Tests a point against every model element that may have a d2 of at most the best.
  CLEARWAY_HD void search_point(std::uint32_t pose, const Vec3& e, double& least,
                                Element& near) const {
    const InversePose& back = sweep_.motion.inverse_poses[pose];
    const Vec3 x = back.apply(e);
    double ball = squared_ball(back, least);
    sweep_.model.any(
        [&](const Box& box) {
          return least_squared_distance(box, x) > ball ? ModelStep::kSkip : ModelStep::kEnter;
        },
        [&](const Element& m) {
          if (!(squared_distance(x, m) > ball) && offer(pose, e, m, least, near)) {
            ball = squared_ball(back, least);
          }
          return false;
        });
  }

  /// Square of a distance from the point pulled back: model points beyond it have only d2 above the
  /// best that is known.
  CLEARWAY_HD double squared_ball(const InversePose& back, double least) const {
    const double ball = reaches_.of(least < bound_ ? least : bound_) / back.least * kRoundedUp;
    return ball * ball * kRoundedUp;
  }

  /// Takes the least d2 of the lanes, unless a known one is better.
  CLEARWAY_HD void take(std::uint32_t begin, PerLane<double>& least, PerLane<Vec3>& e,
                        PerLane<Element>& m) {
    const double squared = Warp::least(least);
    if (!(squared <= bound_ && squared < bests_.limit)) return;
    lower_bound(squared);
    if (squared < found_) {
      found_ = squared;
      ties_.restart();
    }
    const std::uint32_t lanes =
        Warp::ballot([&](std::uint32_t lane) { return least[lane] == squared; });
    ties_.add(first_slot_ + begin, lanes);
    Warp::each([&](std::uint32_t lane) {
      if (lane != lowest_bit(lanes)) return;
      shared_.point = e[lane];
      shared_.element = m[lane];
    });
    has_guess_ = true;
  }

  const SweepRefOf<Element>& sweep_;
  const PageRef& page_;
  const Quantisation& quantisation_;
  const ProfileBests& bests_;
  ProfileReaches reaches_;
  Ties ties_;
  Shared& shared_;
  PerLane<SweepStatistics>& statistics_;
  Blocks blocks_;

  const PageCell* cell_ = nullptr;
  std::uint32_t index_ = 0;        ///< index of the cell in the page
  std::uint32_t first_point_ = 0;  ///< first point of the part, in its cell
  std::uint32_t first_slot_ = 0;   ///< slot of the first point, in the page
  double bound_ = 0;               ///< values of d2 above it do not matter at this pose
  double found_ = kInfinity;       ///< the least d2 found at the last pose
  /// Last pose that was searched, if what it found is still known
  std::uint32_t last_pose_ = kSweepNever;
  bool was_found_ = false;
  bool has_guess_ = false;
  std::conditional_t<kIsSolid<Element>, ProfileDepths<Warp, Ties, Element>, NoDepths> depths_;
};

}  // namespace clearway
