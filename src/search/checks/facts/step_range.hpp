#pragma once

#include <algorithm>
#include <cstdint>

#include "core/geometry/quantum_box.hpp"

namespace clearway {

/// The surroundings of a box, up to a distance, in the steps of a cell's block boxes. Dismisses
/// most blocks before they are decoded, and none that is within the distance.
class StepRange {
 public:
  StepRange(const Box& cell, const Box& box, double distance) {
    for (int k = 0; k < 3; ++k) {
      const double extent = cell.hi[k] - cell.lo[k];
      const double steps = extent > 0 ? static_cast<double>(kBlockBoxSteps) / extent : 0;
      lo_[k] = step((box.lo[k] - distance - cell.lo[k]) * steps - kSlack);
      hi_[k] = step((box.hi[k] + distance - cell.lo[k]) * steps + kSlack);
    }
  }

  bool meets(const BlockBox& block) const {
    bool meets = true;
    for (int k = 0; k < 3; ++k) meets = meets & (block.lo[k] <= hi_[k]) & (block.hi[k] >= lo_[k]);
    return meets;
  }

 private:
  static constexpr double kSlack = 2;  // block boxes are rounded by a step

  static std::int32_t step(double steps) {
    return static_cast<std::int32_t>(std::clamp(steps, -1e9, 1e9));
  }

  std::int32_t lo_[3], hi_[3];
};

}  // namespace clearway
