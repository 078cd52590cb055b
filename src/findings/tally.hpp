#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "core/geometry/quantum_box.hpp"
#include "findings/group/cell_grid.hpp"

namespace clearway {

/// What is summed up of points, in integers: the same in any order.
struct Tally {
  std::uint64_t points = 0;
  std::uint32_t first_row = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t first_pose = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t last_pose = 0;
  QuantumBox box{{kMost, kMost, kMost}, {kLeast, kLeast, kLeast}};
  __int128 sum[3]{};

  void add(const GridPoint& p, std::uint32_t pose) {
    ++points;
    first_row = std::min(first_row, p.row);
    first_pose = std::min(first_pose, pose);
    last_pose = std::max(last_pose, pose);
    for (int k = 0; k < 3; ++k) {
      box.lo[k] = std::min(box.lo[k], p.q[k]);
      box.hi[k] = std::max(box.hi[k], p.q[k]);
      sum[k] += p.q[k];
    }
  }

  void add(const Tally& other) {
    points += other.points;
    first_row = std::min(first_row, other.first_row);
    first_pose = std::min(first_pose, other.first_pose);
    last_pose = std::max(last_pose, other.last_pose);
    box = united(box, other.box);
    for (int k = 0; k < 3; ++k) sum[k] += other.sum[k];
  }

 private:
  static constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  static constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
};

}  // namespace clearway
