#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "core/page/page_engine.hpp"
#include "core/page/pose_reach.hpp"

namespace clearway {

/// A run of planned cells that share a page.
struct PlannedPage {
  std::size_t first;  ///< index of the run's first planned cell
  PageShape shape;    ///< shape of the page that the run fills; shape.cells is the run's length

  std::span<const PlannedCell> of(std::span<const PlannedCell> cells) const {
    return cells.subspan(first, shape.cells);
  }
};

/// The shape of the page that these cells fill. masked: whether the page has masks, as it does if
/// points are ignored. Throws ResourceError if the cells have too many motion nodes for any page.
PageShape page_shape(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                     bool masked = false);

/// Size of the smallest page that holds any one of the cells, with its motion nodes, bytes; 0 for
/// no cells.
std::uint64_t smallest_page_bytes(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                                  bool masked = false);

/// Divides the cells, in their order, into pages of at most `page_bytes` and `most_cells` (not 0),
/// each as full as possible. A pure function; reads no points. Throws ResourceError naming the
/// smallest page if a cell does not fit.
std::vector<PlannedPage> paginate(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                                  std::uint64_t page_bytes, std::uint32_t most_cells,
                                  bool masked = false);

/// The cells within reach of the trajectory, each with the motion nodes that may touch it, in the
/// order in which the trajectory first reaches them. A pure function; reads no points.
std::vector<PlannedCell> plan(const PackedCloud& cloud, const PoseReach& reach);

}  // namespace clearway
