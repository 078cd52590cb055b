#pragma once

#include <cstdint>
#include <span>

#include "findings/group/cell_grid.hpp"
#include "findings/group/neighbourhood.hpp"

namespace clearway {

enum class Nearness { kNear, kFar, kOpen };

/// The absolute difference of two stored integers.
inline std::uint64_t difference_of(const std::int32_t a, const std::int32_t b) {
  return static_cast<std::uint64_t>(a < b ? std::int64_t{b} - a : std::int64_t{a} - b);
}

inline bool are_neighbours(const Neighbourhood& neighbourhood, const GridPoint& a,
                           const GridPoint& b) {
  return neighbourhood.within(difference_of(a.q[0], b.q[0]), difference_of(a.q[1], b.q[1]),
                              difference_of(a.q[2], b.q[2]));
}

/// Whether a point of one cell has a neighbour in the other, found by comparing all pairs.
bool any_neighbours(const Neighbourhood& neighbourhood, std::span<const GridPoint> a,
                    std::span<const GridPoint> b);

/// Whether a point of one cell has a neighbour in the other, in a time proportional to the number
/// of points, which may leave it open: few points are all compared with each other, and of many
/// only those that seem to be nearest.
Nearness compare_cells(const Neighbourhood& neighbourhood, std::span<const GridPoint> a,
                       std::span<const GridPoint> b);

}  // namespace clearway
