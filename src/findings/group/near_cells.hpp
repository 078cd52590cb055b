#pragma once

#include <cstdint>
#include <span>

#include "findings/group/cell_grid.hpp"
#include "findings/group/neighbourhood.hpp"

namespace clearway {

enum class Nearness { kNear, kFar, kOpen };

/// The differences of two points, without sign.
inline std::uint64_t difference_of(const std::int32_t a, const std::int32_t b) {
  return static_cast<std::uint64_t>(a < b ? std::int64_t{b} - a : std::int64_t{a} - b);
}

inline bool are_neighbours(const Neighbourhood& neighbourhood, const GridPoint& a,
                           const GridPoint& b) {
  return neighbourhood.within(difference_of(a.q[0], b.q[0]), difference_of(a.q[1], b.q[1]),
                              difference_of(a.q[2], b.q[2]));
}

/// Whether a point of one has a neighbour in the other: all pairs.
bool any_neighbours(const Neighbourhood& neighbourhood, std::span<const GridPoint> a,
                    std::span<const GridPoint> b);

/// The same in a time that grows as the number of points, which can leave it open: few points are
/// tried with each other, of many those that seem to be nearest.
Nearness compare_cells(const Neighbourhood& neighbourhood, std::span<const GridPoint> a,
                       std::span<const GridPoint> b);

}  // namespace clearway
