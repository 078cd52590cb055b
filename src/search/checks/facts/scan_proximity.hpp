#pragma once

#include <cstdint>

#include "core/cloud/packed_cloud.hpp"
#include "core/geometry/box.hpp"

namespace clearway {

/// How near the scan comes to a box, by the boxes of its blocks of 64 points: no point is read.
/// A block far longer than is usual in the scan lies across a gap between scanned places. Such
/// blocks do not count. Of one thread.
class ScanProximity {
 public:
  /// A cloud with a point at least, which outlives it.
  /// `longest_block`: blocks up to this diagonal count in any case.
  ScanProximity(const PackedCloud& cloud, double longest_block);

  /// The diagonal that half of the blocks do not exceed; of a sample where they are many.
  double typical_block() const { return typical_block_; }

  /// A block's distance to the box, and its own box.
  struct Nearest {
    double distance = 0;
    Box block{};
    bool found = false;
  };

  /// The nearest block that is at most `most` away.
  Nearest nearest(const Box& box, double most) const;

  /// Whether there is a block that is at most `reach` away. Fast where it was so for a box nearby
  /// just before.
  bool within(const Box& box, double reach) const;

 private:
  Box cell_box(std::uint32_t cell) const;
  Box block_box(std::uint32_t cell, std::uint32_t block) const;
  void look_into(std::uint32_t cell, const Box& box, bool any, Nearest& best) const;
  Nearest descend(const Box& box, double most, bool any) const;
  double median_block() const;

  const PackedCloud& cloud_;
  double typical_block_ = 0;
  double longest_block_ = 0;
  mutable Nearest last_;
};

}  // namespace clearway
