#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "core/page/page_engine.hpp"

namespace clearway {

/// A run of planned cells that share a page.
struct PlannedPage {
  std::size_t first;  ///< index of a planned cell
  PageShape shape;    ///< of the page that the run fills; shape.cells is its length

  std::span<const PlannedCell> of(std::span<const PlannedCell> cells) const {
    return cells.subspan(first, shape.cells);
  }
};

/// Of the page that these cells fill. masked: with masks, as where points are ignored. Throws
/// ResourceError where their motion nodes are too many for any page.
PageShape page_shape(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                     bool masked = false);

/// The smallest page that holds any one of the cells, with its motion nodes, bytes; 0 for none.
std::uint64_t smallest_page_bytes(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                                  bool masked = false);

/// Divides the cells, in their order, into pages of at most `page_bytes` and `most_cells` (not 0),
/// each as full as can be. A pure function; reads no points. Throws ResourceError naming the
/// smallest page where a cell does not fit.
std::vector<PlannedPage> paginate(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                                  std::uint64_t page_bytes, std::uint32_t most_cells,
                                  bool masked = false);

}  // namespace clearway
