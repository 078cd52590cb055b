#include "stream/plan.hpp"

#include <algorithm>

namespace clearway {
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
