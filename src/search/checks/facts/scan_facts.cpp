#include "search/checks/facts/scan_facts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/geometry/sweep_bounds.hpp"

namespace clearway {

std::optional<double> height_above_ground(const ScanPoints& points, const Box& body,
                                          const Pose& pose) {
  Box column = body;
  column.lo.z = points.bottom_of_scan(body, pose);
  std::optional<double> height;
  points.visit(column, pose, [&](const Vec3& p, auto...) {
    const double here = std::max(body.lo.z - p.z, 0.0);
    height = std::min(height.value_or(here), here);
    return here > 0;
  });
  return height;
}

namespace {

/// A block that is longer than this many typical blocks lies across a gap.
constexpr double kUsual = 4;

std::uint32_t blocks_of(const Cell& cell) {
  return static_cast<std::uint32_t>(divide_up(cell.count, kBlockPoints));
}

}  // namespace

ScanProximity::ScanProximity(const PackedCloud& cloud, double longest_block)
    : cloud_(cloud),
      typical_block_(cloud.typical_block()),
      longest_block_(std::max(longest_block, kUsual * typical_block_)) {}

Box ScanProximity::cell_box(std::uint32_t cell) const {
  return position_box(cloud_.quantisation(), cloud_.cells()[cell].box);
}

void ScanProximity::look_into(std::uint32_t cell, const Box& box, bool any, Nearest& best) const {
  const StepRange range(cell_box(cell), box, best.distance);
  const BlockBoxes blocks = cloud_.blocks(cell);
  for (std::uint32_t block = 0; block < blocks_of(cloud_.cells()[cell]); ++block) {
    if (!range.meets(blocks[block])) continue;
    const Box place = cloud_.block_box(cell, block);
    const double distance = place.distance(box);
    if (distance > best.distance || (best.found && distance == best.distance)) continue;
    if (2 * half_diagonal(place) > longest_block_) continue;
    best = {distance, place, true};
    if (any || distance == 0) return;
  }
}

ScanProximity::Nearest ScanProximity::descend(const Box& box, double most, bool any) const {
  const std::span<const TreeNode> tree = cloud_.tree();
  const auto distance_of = [&](std::uint32_t node) {
    return position_box(cloud_.quantisation(), tree[node].box).distance(box);
  };
  Nearest best{most};
  std::vector<std::pair<std::uint32_t, double>> open{{0, distance_of(0)}};
  while (!open.empty() && !(best.found && (any || best.distance == 0))) {
    const auto [node, distance] = open.back();
    open.pop_back();
    if (distance > best.distance || (best.found && distance == best.distance)) continue;
    if (tree[node].right == 0) {
      look_into(tree[node].first_cell, box, any, best);
      continue;
    }
    const std::pair left{node + 1, distance_of(node + 1)};
    const std::pair right{tree[node].right, distance_of(tree[node].right)};
    const bool left_first = left.second <= right.second;
    open.push_back(left_first ? right : left);
    open.push_back(left_first ? left : right);
  }
  return best;
}

ScanProximity::Nearest ScanProximity::nearest(const Box& box, double most) const {
  return descend(box, most, false);
}

bool ScanProximity::within(const Box& box, double reach) const {
  if (last_.found && last_.block.distance(box) <= reach) return true;
  const Nearest found = descend(box, reach, true);
  if (found.found) last_ = found;
  return found.found;
}

}  // namespace clearway
