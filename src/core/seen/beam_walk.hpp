#pragma once

#include <cmath>
#include <cstdint>

#include "core/seen/cubes.hpp"

namespace clearway {

/// A box of cells of one size along a beam, both ends included.
struct CellRange {
  std::int32_t lo[3], hi[3];
};

/// Part of a beam, from 0 at its origin to 1 at its point.
struct BeamPart {
  double from, to;
  CLEARWAY_HD bool empty() const { return !(from <= to); }
};

/// Walks along a beam through the cells of a lattice, in double. A cell that the walk leaves out is
/// touched by the true beam only within a millionth of a quantum of its border, and so not in its
/// inner part, because an inset is a quantum or more (docs/design/seen.md, "The walk").
class BeamWalk {
 public:
  CLEARWAY_HD explicit BeamWalk(const Beam& beam) {
    for (int k = 0; k < 3; ++k) {
      origin_[k] = static_cast<double>(beam.origin[k]);
      way_[k] = static_cast<double>(beam.way[k]);
      inverse_[k] = beam.way[k] == 0 ? 0 : 1 / way_[k];
    }
  }

  /// The part of `part` in the cells of a range. side: sides of a cell, quanta.
  CLEARWAY_HD BeamPart clipped(BeamPart part, const CellRange& range,
                               const std::int64_t* side) const {
    for (int k = 0; k < 3; ++k) {
      const double lo = static_cast<double>(range.lo[k]) * static_cast<double>(side[k]);
      const double hi = static_cast<double>(range.hi[k] + 1) * static_cast<double>(side[k]);
      if (way_[k] == 0) {
        if (origin_[k] < lo || origin_[k] > hi) return {1, 0};
        continue;
      }
      double enters = (lo - origin_[k]) * inverse_[k], leaves = (hi - origin_[k]) * inverse_[k];
      if (enters > leaves) {
        const double swapped = enters;
        enters = leaves;
        leaves = swapped;
      }
      if (enters > part.from) part.from = enters;
      if (leaves < part.to) part.to = leaves;
    }
    return part;
  }

  /// Calls visit(cell, from, to) for the cells along a part that is not empty, in their order, with
  /// the ends of the beam's part in each; ends early where that returns false. range: cells
  /// outside it are not visited; a walk that rounding moves out of it is moved back.
  template <typename Visit>
  CLEARWAY_HD void walk(const BeamPart& part, const CellRange& range, const std::int64_t* side,
                        const Visit& visit) const {
    std::int32_t cell[3];
    double next[3];
    for (int k = 0; k < 3; ++k) {
      const double at = origin_[k] + part.from * way_[k];
      const double index = std::floor(at / static_cast<double>(side[k]));
      const double lo = range.lo[k], hi = range.hi[k];
      cell[k] = static_cast<std::int32_t>(index < lo ? lo : (index > hi ? hi : index));
      next[k] = crossing(k, cell[k], side[k]);
    }
    double from = part.from;
    while (true) {
      const int axis =
          next[0] <= next[1] ? (next[0] <= next[2] ? 0 : 2) : (next[1] <= next[2] ? 1 : 2);
      const bool ends = !(next[axis] < part.to);
      if (!visit(cell, from, ends ? part.to : next[axis])) return;
      if (ends) return;
      from = next[axis] > from ? next[axis] : from;
      cell[axis] += way_[axis] > 0 ? 1 : -1;
      if (cell[axis] < range.lo[axis] || cell[axis] > range.hi[axis]) return;
      next[axis] = crossing(axis, cell[axis], side[axis]);
    }
  }

 private:
  /// Where the beam leaves a cell along an axis; 2, which no beam reaches, where it never does.
  CLEARWAY_HD double crossing(int axis, std::int32_t cell, std::int64_t side) const {
    if (way_[axis] == 0) return 2;
    const std::int64_t border = (std::int64_t{cell} + (way_[axis] > 0 ? 1 : 0)) * side;
    return (static_cast<double>(border) - origin_[axis]) * inverse_[axis];
  }

  double origin_[3], way_[3], inverse_[3];
};

}  // namespace clearway
