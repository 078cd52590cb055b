#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "core/geometry/quantum_box.hpp"
#include "findings/group/cell_grid.hpp"

namespace clearway {

/// Sums over a set of points, in integers, so that they are the same in any order.
struct Tally {
  std::uint64_t points = 0;
  std::uint32_t first_row = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t first_pose = std::numeric_limits<std::uint32_t>::max();
  /// The smallest row of a point with that first pose.
  std::uint32_t first_touched = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t latest_first_pose = 0;
  std::uint32_t last_pose = 0;
  QuantumBox box{{kMost, kMost, kMost}, {kLeast, kLeast, kLeast}};
  __int128 sum[3]{};

  void add(const GridPoint& p, std::uint32_t first, std::uint32_t last) {
    ++points;
    first_row = std::min(first_row, p.row);
    add_first(first, p.row);
    latest_first_pose = std::max(latest_first_pose, first);
    last_pose = std::max(last_pose, last);
    box.extend(p.q);
    for (int k = 0; k < 3; ++k) sum[k] += p.q[k];
  }

  void add(const Tally& other) {
    points += other.points;
    first_row = std::min(first_row, other.first_row);
    add_first(other.first_pose, other.first_touched);
    latest_first_pose = std::max(latest_first_pose, other.latest_first_pose);
    last_pose = std::max(last_pose, other.last_pose);
    box = box.united(other.box);
    for (int k = 0; k < 3; ++k) sum[k] += other.sum[k];
  }

 private:
  /// Takes a first pose and its row; of equal poses the smallest row.
  void add_first(std::uint32_t pose, std::uint32_t row) {
    first_touched = pose < first_pose    ? row
                    : pose == first_pose ? std::min(first_touched, row)
                                         : first_touched;
    first_pose = std::min(first_pose, pose);
  }

  static constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  static constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
};

}  // namespace clearway
