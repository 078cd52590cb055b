#pragma once

#include <cstdint>
#include <optional>

#include "clearway/pose.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/cloud/scan_points.hpp"
#include "core/geometry/box.hpp"

namespace clearway {

/// How high a box of the model's frame stands at a pose above the highest point below it, along the
/// model's z axis; 0 where a point is in the box, and nothing where no point is below it. Throws
/// InputError where a cell is damaged.
std::optional<double> height_above_ground(const ScanPoints& points, const Box& body,
                                          const Pose& pose);

/// How near the scan comes to a box, by the boxes of its blocks of 64 points; no point is read. A
/// block that is far longer than usual in the scan lies across a gap between scanned places, and
/// does not count. Not thread-safe.
class ScanProximity {
 public:
  /// The cloud has at least one point and outlives this object. longest_block: blocks with a
  /// diagonal up to this length count in any case, in the environment's unit.
  ScanProximity(const PackedCloud& cloud, double longest_block);

  /// PackedCloud::typical_block().
  double typical_block() const { return typical_block_; }

  /// A block of the scan and its distance to the box that was asked about.
  struct Nearest {
    double distance = 0;
    Box block{};
    bool found = false;
  };

  /// The nearest block that is at most `most` away from the box; found is false where there is
  /// none.
  Nearest nearest(const Box& box, double most) const;

  /// Whether there is a block at most `reach` away from the box. Fast where this held for a nearby
  /// box just before.
  bool within(const Box& box, double reach) const;

 private:
  Box cell_box(std::uint32_t cell) const;
  void look_into(std::uint32_t cell, const Box& box, bool any, Nearest& best) const;
  Nearest descend(const Box& box, double most, bool any) const;

  const PackedCloud& cloud_;
  double typical_block_ = 0;
  double longest_block_ = 0;
  mutable Nearest last_;
};

}  // namespace clearway
