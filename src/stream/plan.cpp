#include "stream/plan.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <string>

#include "clearway/error.hpp"

namespace clearway {
namespace {

constexpr std::uint64_t kMostNodes = std::numeric_limits<std::uint32_t>::max();

/// The shape with one cell more; none if that would be too large for any page.
std::optional<PageShape> with_cell(PageShape shape, const PackedCloud& cloud,
                                   const PlannedCell& cell) {
  if (shape.nodes + cell.nodes.size() > kMostNodes) return std::nullopt;
  ++shape.cells;
  shape.nodes += static_cast<std::uint32_t>(cell.nodes.size());
  shape.payload_bytes += cloud.packed_bytes(cell.cell);
  return shape;
}

}  // namespace

PageShape page_shape(const PackedCloud& cloud, std::span<const PlannedCell> cells, bool masked) {
  PageShape shape{.blocks_per_cell = cloud.blocks_per_cell(), .masked = masked};
  for (const PlannedCell& cell : cells) {
    const std::optional<PageShape> longer = with_cell(shape, cloud, cell);
    if (!longer) throw ResourceError("cells with too many motion nodes for one page");
    shape = *longer;
  }
  return shape;
}

std::uint64_t smallest_page_bytes(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                                  bool masked) {
  std::uint64_t bytes = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    bytes = std::max(bytes, page_shape(cloud, cells.subspan(i, 1), masked).bytes());
  }
  return bytes;
}

std::vector<PlannedPage> paginate(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                                  std::uint64_t page_bytes, std::uint32_t most_cells, bool masked) {
  std::vector<PlannedPage> pages;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!pages.empty() && pages.back().shape.cells < most_cells) {
      PageShape& shape = pages.back().shape;
      const std::optional<PageShape> longer = with_cell(shape, cloud, cells[i]);
      if (longer && longer->bytes() <= page_bytes) {
        shape = *longer;
        continue;
      }
    }
    pages.push_back({i, page_shape(cloud, cells.subspan(i, 1), masked)});
    if (pages.back().shape.bytes() > page_bytes) {
      throw ResourceError("a page of " + std::to_string(page_bytes) +
                          " bytes is too small for these cells, expected at least " +
                          std::to_string(smallest_page_bytes(cloud, cells, masked)));
    }
  }
  return pages;
}

namespace {

class Planner {
 public:
  Planner(const PackedCloud& cloud, const PoseReach& reach) : cloud_(cloud), reach_(reach) {}

  std::vector<PlannedCell> plan() {
    const std::vector<std::uint32_t> root{0};
    descend(0, root);
    return std::move(cells_);
  }

 private:
  void descend(std::uint32_t index, std::span<const std::uint32_t> nodes) {
    const TreeNode& node = cloud_.tree()[index];
    std::vector<std::uint32_t> open;
    reach_.narrow(position_box(cloud_.quantisation(), node.box), nodes, open);
    if (open.empty()) return;
    if (node.right == 0) {
      cells_.push_back({node.first_cell, std::move(open)});
      return;
    }
    descend(index + 1, open);
    descend(node.right, open);
  }

  const PackedCloud& cloud_;
  const PoseReach& reach_;
  std::vector<PlannedCell> cells_;
};

}  // namespace

std::vector<PlannedCell> plan(const PackedCloud& cloud, const PoseReach& reach) {
  const MotionTree& motion = reach.motion();
  if (cloud.tree().empty() || motion.nodes().empty()) return {};
  std::vector<PlannedCell> cells = Planner(cloud, reach).plan();
  const auto first_pose = [&motion](const PlannedCell& cell) {
    return motion.nodes()[cell.nodes.front()].first;  // nodes are in the order of their poses
  };
  std::stable_sort(cells.begin(), cells.end(), [&](const PlannedCell& a, const PlannedCell& b) {
    return first_pose(a) < first_pose(b);
  });
  return cells;
}

}  // namespace clearway
