#pragma once

#include <cstdint>

#include "core/util/progress.hpp"
#include "findings/group/cell_grid.hpp"
#include "findings/group/neighbourhood.hpp"
#include "findings/group/union_find.hpp"

namespace clearway {

/// The most bytes that trees and lists of open pairs take for a point.
inline constexpr std::uint64_t kJoinBytesOfPoint = 20;

/// Unites the cells that hold neighbours, directly or through others. Points may change their order
/// within a cell. Runs in the caller's arena of oneTBB. Throws Interrupted.
void join_cells(CellGrid& grid, const Neighbourhood& neighbourhood, UnionFind& sets,
                Progress& progress);

}  // namespace clearway
