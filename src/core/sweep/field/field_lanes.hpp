#pragma once

#include <cstdint>

#include "core/cloud/packed_cloud.hpp"
#include "core/sweep/field/model_field_ref.hpp"
#include "core/trajectory/motion_tree_ref.hpp"

namespace clearway {

/// Looks up many places of a ModelField at once, in vectors of the processor. Each gets what
/// ModelFieldRef::bounds() gives, bit for bit. On the host only.
class FieldLanes {
 public:
  static constexpr std::uint32_t kMost = kBlockPoints;

  /// field: must outlive this object.
  explicit FieldLanes(const ModelFieldRef& field) : field_(field) {}

  /// Drops the points of the last look-up.
  void clear() { count_ = 0; }
  /// Adds a point in a lane of its own, after those added before; at most kMost.
  void add(const Vec3& e) {
    for (int k = 0; k < 3; ++k) x_[k][count_] = e[k];
    ++count_;
  }
  std::uint32_t count() const { return count_; }

  /// Looks up the points that were added, at least one, pulled back by a pose.
  void look_up(const InversePose& back);

  double squared_lower(std::uint32_t lane) const { return squared_lower_[lane]; }
  /// The lanes that farther(least, squared_lower, reach) does not hold for, as bits.
  std::uint64_t within(double least, double reach);
  /// What ModelFieldRef::bounds() names as near.
  std::uint32_t near(std::uint32_t lane) const {
    return near_[lane] < 0 ? field_.bounds(place(lane)).near : field_.nearest[near_[lane]];
  }
  /// The point as it was pulled back.
  Vec3 place(std::uint32_t lane) const { return {x_[0][lane], x_[1][lane], x_[2][lane]}; }

 private:
  static constexpr std::uint32_t kVector = 16;  ///< lanes are computed in multiples of so many
  static constexpr std::int32_t kOutside = -1;
  /// Bricks up to this one have only nodes that 32 bits with a sign can number.
  static constexpr std::uint32_t kMostBricks = 0x7fffffff / ModelFieldRef::kBrickNodes - 1;

  // `filled`: the lanes in use, rounded up to whole vectors.
  static void place_all(const ModelFieldRef& field, const InversePose& back, std::uint32_t filled,
                        FieldLanes& lanes);
  static void bound_all(const ModelFieldRef& field, std::uint32_t filled, FieldLanes& lanes);

  static void compare_all(double least, double squared_reach, FieldLanes& lanes);

  const ModelFieldRef& field_;
  std::uint32_t count_ = 0;             ///< lanes in use
  alignas(64) double x_[3][kMost];      ///< points, then the points pulled back
  alignas(64) double place_[3][kMost];  ///< places in their fine voxels, in steps of these
  alignas(64) double squared_lower_[kMost] = {};
  alignas(64) std::uint8_t is_within_[kMost];
  alignas(64) std::int32_t cell_[kMost];  ///< coarse cell, or kOutside
  alignas(64) std::int32_t low_[kMost];   ///< first node of the fine voxel, in its brick or of all
  alignas(64) std::int32_t near_[kMost];  ///< nearest fine node, likewise; negative: there is none
};

}  // namespace clearway
