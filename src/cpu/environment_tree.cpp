#include "cpu/environment_tree.hpp"

#include <algorithm>

namespace clearway {
namespace {

std::uint32_t block_count(const Cell& cell) {
  return static_cast<std::uint32_t>(divide_up(cell.count, kBlockPoints));
}

}  // namespace

EnvironmentTree::EnvironmentTree(const PackedCloud& cloud)
    : cloud_(cloud),
      cells_(cloud.cells()),
      blocks_(cloud.blocks()),
      blocks_per_cell_(cloud.blocks_per_cell()) {}

void EnvironmentTree::fill_inner_boxes(std::uint32_t cell, std::span<BlockBox> inner) const {
  unite_blocks(cell, 0, block_count(cells_[cell]), inner);
}

BlockBox EnvironmentTree::unite_blocks(std::uint32_t cell, std::uint32_t first, std::uint32_t count,
                                       std::span<BlockBox> inner) const {
  if (count == 1) return blocks_[block_index(cell, first)];
  const auto left = static_cast<std::uint32_t>(left_count(count, 1));
  const BlockBox box = unite_blocks(cell, first, left, inner)
                           .united(unite_blocks(cell, first + left, count - left, inner));
  inner[inner_in_cell({EnvironmentNode::kInCell, cell, first, count})] = box;
  return box;
}

EnvironmentNode EnvironmentTree::from_top(std::uint32_t index) const {
  const TreeNode& node = cloud_.tree()[index];
  if (node.right != 0) return {index, 0, 0, 0};
  return cell(node.first_cell);
}

EnvironmentNode EnvironmentTree::cell(std::uint32_t cell) const {
  return {EnvironmentNode::kInCell, cell, 0, block_count(cells_[cell])};
}

std::array<EnvironmentNode, 2> EnvironmentTree::children(const EnvironmentNode& node) const {
  if (node.top != EnvironmentNode::kInCell) {
    return {from_top(node.top + 1), from_top(cloud_.tree()[node.top].right)};
  }
  const auto left = static_cast<std::uint32_t>(left_count(node.block_count, 1));
  return {EnvironmentNode{EnvironmentNode::kInCell, node.cell, node.first_block, left},
          EnvironmentNode{EnvironmentNode::kInCell, node.cell, node.first_block + left,
                          node.block_count - left}};
}

Box EnvironmentTree::box(const EnvironmentNode& node, std::span<const BlockBox> inner) const {
  const Quantisation& quantisation = cloud_.quantisation();
  if (node.top != EnvironmentNode::kInCell) {
    return position_box(quantisation, cloud_.tree()[node.top].box);
  }
  const BlockBox& inside = node.block_count == 1 ? blocks_[block_index(node.cell, node.first_block)]
                                                 : inner[inner_in_cell(node)];
  return position_box(quantisation, decode_block_box(cells_[node.cell].box, inside));
}

}  // namespace clearway
