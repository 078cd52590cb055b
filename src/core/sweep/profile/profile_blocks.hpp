#pragma once

#include <cmath>
#include <cstdint>

#include "core/sweep/sweep_page.hpp"
#include "core/util/device_bits.hpp"
#include "core/util/warp.hpp"

namespace clearway {

/// The blocks of a cell that may hold the nearest point of poses, for one warp: one bit for each
/// block, 32 blocks in a word, one word for each lane, on as many levels as a descent of the motion
/// tree has.
template <typename Warp, typename Element>
class ProfileBlocks {
 public:
  template <typename Value>
  using PerLane = typename Warp::template PerLane<Value>;

  /// Number of blocks of a cell that are searched together; larger cells are searched in parts.
  static constexpr std::uint32_t kPartBlocks = kWarpLanes * kWarpLanes;
  static constexpr std::uint32_t kLevels = 14;
  static constexpr std::uint32_t kNone = 0xffffffff;

  struct Sphere {
    Vec3 centre;
    double rho;
  };

  /// The memory that the lanes share.
  struct Shared {
    Sphere words[kWarpLanes];
    std::uint32_t open[kLevels][kWarpLanes];
  };

  CLEARWAY_HD ProfileBlocks(const SweepRefOf<Element>& sweep, const PageRef& page,
                            const Quantisation& quantisation, Shared& shared,
                            PerLane<SweepStatistics>& statistics)
      : sweep_(sweep),
        page_(page),
        quantisation_(quantisation),
        shared_(shared),
        statistics_(statistics) {}

  /// Begins a part of a cell, with all blocks that have points open at level 0. Returns whether the
  /// part has any block.
  CLEARWAY_HD bool enter(std::uint32_t cell, std::uint32_t part) {
    cell_ = &page_.cell(cell);
    index_ = cell;
    first_block_ = part * kPartBlocks;
    first_ = page_.blocks(cell) + std::uint64_t{part} * kPartBlocks;
    const auto blocks = static_cast<std::uint32_t>(divide_up(cell_->count, kBlockPoints));
    if (part * kPartBlocks >= blocks) return false;
    const std::uint32_t left = blocks - part * kPartBlocks;
    count_ = left < kPartBlocks ? left : kPartBlocks;
    Warp::sync();
    Warp::each([&](std::uint32_t lane) {
      const std::uint32_t first = lane * kWarpLanes;
      const std::uint32_t of_word = first < count_ ? count_ - first : 0;
      shared_.open[0][lane] = with_points(first, of_word);
      if (of_word > 0) {
        shared_.words[lane] = sphere_of(first, of_word < kWarpLanes ? of_word : kWarpLanes);
      }
    });
    return true;
  }

  /// Looks at the blocks open at a level, all at once at the middle one of some poses. Those that
  /// may matter to the poses become open at the next level. reach: a distance beyond which nothing
  /// matters to these poses. Returns whether any block is left.
  CLEARWAY_HD bool look(const PosesAround& poses, std::uint32_t level, double reach) {
    inside_ = false;
    return look_at_open(poses, level, reach);
  }

  /// Looks at the blocks open at a level as look() does, but opens those that may hold points
  /// inside solids.
  CLEARWAY_HD bool look_inside(const PosesAround& poses, std::uint32_t level) {
    inside_ = true;
    return look_at_open(poses, level, sweep_.rounding);
  }

  CLEARWAY_HD Sphere sphere(std::uint32_t block) const { return sphere_of(block, 1); }

  // Results of the last look:

  /// The reach that was given, or a smaller one if the blocks themselves prove it for these poses.
  CLEARWAY_HD double reach() const { return reach_; }
  CLEARWAY_HD void lower_reach(double reach) {
    if (reach < reach_) reach_ = reach;
  }

  /// Whether anything within rho of a place with this bound from the field may matter.
  CLEARWAY_HD bool matters(double rho, double squared_lower) const {
    return !farther(sweep_.motion.inverse_poses[poses_.pose].least, squared_lower,
                    reach_ + poses_.delta + rho);
  }

  /// The block that seems to be nearest, or kNone.
  CLEARWAY_HD std::uint32_t nearest() const { return nearest_; }

  CLEARWAY_HD std::uint32_t word_count() const {
    return static_cast<std::uint32_t>(divide_up(count_, kWarpLanes));
  }

  /// The blocks of a word that are open at a level and still matter with the present reach. except:
  /// a block to be left out, or kNone.
  CLEARWAY_HD std::uint32_t still_open(std::uint32_t word, std::uint32_t level,
                                       std::uint32_t except) {
    std::uint32_t open = shared_.open[level][word];
    if (except / kWarpLanes == word) open &= ~(1U << (except % kWarpLanes));
    if (open == 0) return 0;
    return Warp::ballot([&](std::uint32_t lane) {
      if ((open >> lane & 1) == 0) return false;
      double upper = 0;
      const Sphere sphere = sphere_of(word * kWarpLanes + lane, 1);
      return matters(sphere.rho, look_at(sphere, lane, upper));
    });
  }

 private:
  /// The blocks that have points to search, as bits, of the `count` blocks from `first` on. The box
  /// of any other block says nothing of how near a point is.
  CLEARWAY_HD std::uint32_t with_points(std::uint32_t first, std::uint32_t count) const {
    if (!page_.shape.masked) return count >= kWarpLanes ? ~0U : (1U << count) - 1;
    std::uint32_t blocks = 0;
    for (std::uint32_t i = 0; i < count && i < kWarpLanes; ++i) {
      if (page_.searched(index_, first_block_ + first + i) != 0) blocks |= 1U << i;
    }
    return blocks;
  }

  CLEARWAY_HD Sphere sphere_of(std::uint32_t first, std::uint32_t count) const {
    QuantumBox box = decode_block_box(cell_->box, first_[first]);
    for (std::uint32_t i = first + 1; i < first + count; ++i) {
      box = box.united(decode_block_box(cell_->box, first_[i]));
    }
    const Box positions = position_box(quantisation_, box);
    return {positions.centre(), half_diagonal(positions)};
  }

  CLEARWAY_HD bool look_at_open(const PosesAround& poses, std::uint32_t level, double reach) {
    poses_ = poses;
    reach_ = reach;
    nearest_ = kNone;
    nearest_squared_ = kInfinity;
    PerLane<double> upper;
    PerLane<double> squared_lower;
    Warp::sync();  // still_open() may have ended without a ballot
    Warp::each([&](std::uint32_t lane) {
      shared_.open[level + 1][lane] = 0;
      upper[lane] = kInfinity;
      if (shared_.open[level][lane] == 0) return;
      squared_lower[lane] = look_at(shared_.words[lane], lane, upper[lane]);
    });
    lower_reach(Warp::least(upper));
    std::uint32_t words = Warp::ballot([&](std::uint32_t lane) {
      return shared_.open[level][lane] != 0 &&
             matters(shared_.words[lane].rho, squared_lower[lane]);
    });
    bool any = false;
    for (; words != 0; words &= words - 1) any |= look_at_word(lowest_bit(words), level);
    return any;
  }

  CLEARWAY_HD bool look_at_word(std::uint32_t word, std::uint32_t level) {
    const std::uint32_t open = shared_.open[level][word];
    PerLane<double> upper;
    PerLane<double> squared_lower;
    PerLane<double> rho;
    Warp::each([&](std::uint32_t lane) {
      upper[lane] = squared_lower[lane] = kInfinity;
      if ((open >> lane & 1) == 0) return;
      const Sphere sphere = sphere_of(word * kWarpLanes + lane, 1);
      rho[lane] = sphere.rho;
      squared_lower[lane] = look_at(sphere, lane, upper[lane]);
    });
    lower_reach(Warp::least(upper));
    const double least = Warp::least(squared_lower);
    const std::uint32_t keep = Warp::ballot([&](std::uint32_t lane) {
      return (open >> lane & 1) != 0 && matters(rho[lane], squared_lower[lane]);
    });
    Warp::each([&](std::uint32_t lane) {
      if (lane == 0) shared_.open[level + 1][word] = keep;
    });
    const std::uint32_t nearest = Warp::ballot([&](std::uint32_t lane) {
      return (keep >> lane & 1) != 0 && squared_lower[lane] == least;
    });
    if (least < nearest_squared_ && nearest != 0) {
      nearest_squared_ = least;
      nearest_ = word * kWarpLanes + lowest_bit(nearest);
    }
    return keep != 0;
  }

  /// The field's bound at the centre of a sphere; infinity if the sphere is below the floor at all
  /// poses. upper: becomes a distance that no point of the sphere exceeds at any of the poses, up
  /// to the rounding of a test, if all points count at all poses. When looking for points inside
  /// solids, returns 0 instead of the bound if the whole sphere is inside, and leaves `upper`
  /// alone.
  CLEARWAY_HD double look_at(const Sphere& sphere, std::uint32_t lane, double& upper) {
    ++statistics_[lane].node_tests;
    const FloorSide side =
        sweep_.floor_side(poses_, sphere.centre, {sphere.rho, sphere.rho, sphere.rho});
    if (side == FloorSide::kBelow) return kInfinity;
    const Vec3 x = sweep_.motion.inverse_poses[poses_.pose].apply(sphere.centre);
    const ModelFieldRef::Bounds bounds = sweep_.field.bounds(x);
    if constexpr (kIsSolid<Element>) {
      if (inside_) {
        const bool is_same = !matters(sphere.rho, bounds.squared_lower);
        return is_same && sweep_.is_inside(x, bounds.squared_lower) ? 0 : bounds.squared_lower;
      }
    }
    if (bounds.near != ModelFieldRef::kNone && side == FloorSide::kAbove) {
      const Element m =
          transform(sweep_.motion.poses[poses_.pose], sweep_.model.elements[bounds.near]);
      upper = std::sqrt(squared_distance(sphere.centre, m)) * kRoundedUp + sphere.rho +
              poses_.delta + 2 * sweep_.rounding;
    }
    return bounds.squared_lower;
  }

  const SweepRefOf<Element>& sweep_;
  const PageRef& page_;
  const Quantisation& quantisation_;
  Shared& shared_;
  PerLane<SweepStatistics>& statistics_;

  const PageCell* cell_ = nullptr;
  const BlockBox* first_ = nullptr;
  std::uint32_t index_ = 0;        ///< index of the cell in the page
  std::uint32_t first_block_ = 0;  ///< first block of the part, in the cell
  std::uint32_t count_ = 0;
  PosesAround poses_{0};
  double reach_ = 0;
  bool inside_ = false;  ///< whether points inside solids are looked for
  std::uint32_t nearest_ = kNone;
  double nearest_squared_ = kInfinity;
};

}  // namespace clearway
