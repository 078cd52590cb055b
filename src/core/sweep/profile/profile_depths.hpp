#pragma once

#include <cmath>
#include <cstdint>

#include "core/sweep/profile/profile_blocks.hpp"
#include "core/sweep/profile/sweep_profile.hpp"
#include "core/sweep/solid_depth.hpp"

namespace clearway {

/// Finds by one warp, for the poses of motion nodes, the points of a cell that lie deepest inside
/// solids. It descends the motion tree as ProfileSearch does, whose blocks and ties it uses, and
/// carries along the blocks that may hold points inside. Points are given up only if a bound proves
/// every computed depth to be below the best of the pose, so that ties stay
/// (docs/design/numerics.md, "Solids"). The search works on v, the negative of a squared depth.
template <typename Warp, typename Ties, typename Element>
class ProfileDepths {
 public:
  using Blocks = ProfileBlocks<Warp, Element>;
  template <typename Value>
  using PerLane = typename Warp::template PerLane<Value>;

  /// All arguments must outlive this object.
  CLEARWAY_HD ProfileDepths(const SweepRefOf<Element>& sweep, const PageRef& page,
                            const Quantisation& quantisation, const ProfileBests& bests,
                            Blocks& blocks, Ties& ties, PerLane<SweepStatistics>& statistics)
      : sweep_(sweep),
        page_(page),
        quantisation_(quantisation),
        bests_(bests),
        blocks_(blocks),
        ties_(ties),
        statistics_(statistics) {}

  /// Begins a part of a cell, which ProfileSearch has entered. cell: its index in the page;
  /// first_point: the part's first point in the cell; first_slot: that point's slot in the page.
  CLEARWAY_HD void enter(std::uint32_t cell, std::uint32_t first_point, std::uint32_t first_slot) {
    cell_ = &page_.cell(cell);
    index_ = cell;
    first_point_ = first_point;
    first_slot_ = first_slot;
  }

  /// Searches all poses of a motion node and notes the deepest points.
  CLEARWAY_HD void search(std::uint32_t top) {
    const MotionNode* nodes = sweep_.motion.nodes;
    std::uint32_t later[Blocks::kLevels];  // halves still to be searched, for each level
    std::uint32_t level = 0, open = 0;     // open: one bit for each level that has such a half
    last_pose_ = kSweepNever;
    for (std::uint32_t at = top;;) {
      if (descends(nodes[at], level)) {
        later[level] = nodes[at].later;
        open |= 1U << level++;
        ++at;
        continue;
      }
      if (open == 0) return;
      while ((open >> --level & 1) == 0) {
      }
      open &= ~(1U << level);
      at = later[level++];
    }
  }

  /// Searches one pose, for which values v above `bound` do not matter, but those equal to it do.
  /// Passes the least v found, which is below 0, to the ties and returns it; returns infinity if
  /// there is none.
  CLEARWAY_HD double search_pose(std::uint32_t pose, std::uint32_t level, double bound) {
    bound_ = bound;
    found_ = kInfinity;
    if (!blocks_.look_inside({pose}, level)) return found_;
    for (std::uint32_t word = 0; word < blocks_.word_count(); ++word) {
      std::uint32_t open = blocks_.still_open(word, level + 1, Blocks::kNone);
      for (; open != 0; open &= open - 1) {
        search_block(pose, word * kWarpLanes + lowest_bit(open));
      }
    }
    return found_;
  }

 private:
  /// Levels of the descent; below them, poses are looked at one by one.
  static constexpr std::uint32_t kPathLevels = Blocks::kLevels - 2;

  /// Whether the halves of a node are to be searched. Searches the poses itself where they are not
  /// divided further.
  CLEARWAY_HD bool descends(const MotionNode& node, std::uint32_t level) {
    if (node.count == 1) {
      search_single(node.mid, level);
      return false;
    }
    if (!blocks_.look_inside(sweep_.around(node), level)) return false;
    if (level + 1 < kPathLevels) return true;
    for (std::uint32_t i = 0; i < node.count; ++i) search_single(node.first + i, level + 1);
    return false;
  }

  CLEARWAY_HD void search_single(std::uint32_t pose, std::uint32_t level) {
    const double bound = Warp::once([&] { return load_shared(bests_.of_pose + pose); });
    const bool is_stop = last_pose_ != kSweepNever && last_pose_ + 1 == pose &&
                         sweep_.motion.poses[pose] == sweep_.motion.poses[last_pose_];
    last_pose_ = pose;
    if (!is_stop) search_pose(pose, level, bound);
    if (!(found_ < 0 && found_ <= bound)) return;
    Warp::each([&](std::uint32_t lane) {
      if (lane != 0) return;
      lower_shared_below_0(bests_.of_pose + pose, found_);
      ties_.keep(pose, found_);
    });
  }

  /// Searches the points of a block, unless none can matter: no point of it is deeper than its
  /// centre by more than rho.
  CLEARWAY_HD void search_block(std::uint32_t pose, std::uint32_t block) {
    if (bound_ < 0) {
      const typename Blocks::Sphere sphere = blocks_.sphere(block);
      SweepStatistics not_counted;
      const double more = sphere.rho + 2 * sweep_.rounding;
      const double squared = DepthAtPose<Element>(sweep_, sphere.centre, not_counted)
                                 .squared(pose, squared_depth_below(-bound_, more), near_);
      const double most = (std::sqrt(squared) + more) * kRoundedUp;
      if (most * most * kRoundedUp < -bound_) return;
    }
    for (std::uint32_t begin = block * kBlockPoints; begin < (block + 1) * kBlockPoints;
         begin += kWarpLanes) {
      if (first_point_ + begin < cell_->count) search_points(pose, begin);
    }
  }

  /// Searches 32 points of a block, one by each lane.
  CLEARWAY_HD void search_points(std::uint32_t pose, std::uint32_t begin) {
    PerLane<double> least;
    Warp::each([&](std::uint32_t lane) {
      least[lane] = kInfinity;
      const std::uint32_t index = first_point_ + begin + lane;
      if (!page_.is_searched(index_, index)) return;
      const Vec3 e = page_.position(quantisation_, *cell_, index);
      ++statistics_[lane].point_tests;
      if (!may_be_inside(pose, e) || !sweep_.counts(e, pose)) return;
      // A depth below the bound need not be exact, because its value stays above the bound.
      std::uint32_t near = near_;
      const double squared = DepthAtPose<Element>(sweep_, e, statistics_[lane])
                                 .squared(pose, bound_ < 0 ? -bound_ : 0, near);
      if (squared > 0) least[lane] = 0 - squared;
    });
    const double value = Warp::least(least);
    if (!(value < 0 && value <= bound_)) return;
    bound_ = value;
    if (value < found_) {
      found_ = value;
      ties_.restart();
    }
    ties_.add(first_slot_ + begin,
              Warp::ballot([&](std::uint32_t lane) { return least[lane] == value; }));
  }

  CLEARWAY_HD bool may_be_inside(std::uint32_t pose, const Vec3& e) const {
    const InversePose& back = sweep_.motion.inverse_poses[pose];
    const Vec3 x = back.apply(e);
    const double squared_lower = sweep_.field.bounds(x).squared_lower;
    return !farther(back.least, squared_lower, sweep_.rounding) ||
           sweep_.is_inside(x, squared_lower);
  }

  const SweepRefOf<Element>& sweep_;
  const PageRef& page_;
  const Quantisation& quantisation_;
  const ProfileBests& bests_;
  Blocks& blocks_;
  Ties& ties_;
  PerLane<SweepStatistics>& statistics_;

  const PageCell* cell_ = nullptr;
  std::uint32_t index_ = 0;  ///< index of the cell in the page
  std::uint32_t first_point_ = 0, first_slot_ = 0;
  std::uint32_t near_ = 0;                 ///< triangle of the solids from which searches begin
  double bound_ = 0;                       ///< values v above it do not matter at this pose
  double found_ = kInfinity;               ///< the least v found at the last pose
  std::uint32_t last_pose_ = kSweepNever;  ///< last pose that was searched
};

/// Takes the place of ProfileDepths for a model without solids.
struct NoDepths {
  template <typename... Given>
  CLEARWAY_HD explicit NoDepths(Given&&...) {}
};

}  // namespace clearway
