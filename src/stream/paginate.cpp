#include "stream/paginate.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include "core/error.hpp"

namespace clearway {
namespace {

PageShape with_cell(PageShape shape, const PackedCloud& cloud, const PlannedCell& cell) {
  ++shape.cells;
  shape.nodes += static_cast<std::uint32_t>(cell.nodes.size());
  shape.payload_bytes += cloud.packed_bytes(cell.cell);
  return shape;
}

}  // namespace

std::uint64_t smallest_page_bytes(const PackedCloud& cloud, std::span<const PlannedCell> cells) {
  std::uint64_t bytes = 0;
  for (const PlannedCell& cell : cells) {
    const PageShape empty{.blocks_per_cell = cloud.blocks_per_cell()};
    bytes = std::max(bytes, with_cell(empty, cloud, cell).bytes());
  }
  return bytes;
}

std::vector<PlannedPage> paginate(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                                  std::uint64_t page_bytes, std::uint32_t most_cells) {
  const PageShape empty{.blocks_per_cell = cloud.blocks_per_cell()};
  constexpr std::uint64_t kMostNodes = std::numeric_limits<std::uint32_t>::max();
  std::vector<PlannedPage> pages;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!pages.empty()) {
      PageShape& shape = pages.back().shape;
      const PageShape longer = with_cell(shape, cloud, cells[i]);
      if (longer.cells <= most_cells && longer.bytes() <= page_bytes &&
          std::uint64_t{shape.nodes} + cells[i].nodes.size() <= kMostNodes) {
        shape = longer;
        continue;
      }
    }
    pages.push_back({i, with_cell(empty, cloud, cells[i])});
    if (pages.back().shape.bytes() > page_bytes) {
      throw ResourceError("a page of " + std::to_string(page_bytes) +
                          " bytes is too small for these cells, expected at least " +
                          std::to_string(smallest_page_bytes(cloud, cells)));
    }
  }
  return pages;
}

}  // namespace clearway
