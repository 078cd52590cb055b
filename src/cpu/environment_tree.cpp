#include "cpu/environment_tree.hpp"

#include <algorithm>

namespace clearway {
namespace {

std::uint32_t block_count(const Cell& cell) {
  return static_cast<std::uint32_t>(divide_up(cell.count, kBlockPoints));
}

/// The two halves of a node in a cell.
std::array<EnvironmentNode, 2> halves(const EnvironmentNode& node) {
  const auto left = static_cast<std::uint32_t>(left_count(node.block_count, 1));
  return {EnvironmentNode{EnvironmentNode::kInCell, node.cell, node.first_block, left},
          EnvironmentNode{EnvironmentNode::kInCell, node.cell, node.first_block + left,
                          node.block_count - left}};
}

/// The box of a node in a cell; fills those of the inner nodes in it.
BlockBox unite_blocks(const BlockBoxes& blocks, const EnvironmentNode& node,
                      std::span<BlockBox> inner) {
  if (node.is_block()) return blocks[node.first_block];
  const auto [left, right] = halves(node);
  return inner[EnvironmentTree::inner_in_cell(node)] =
             unite_blocks(blocks, left, inner).united(unite_blocks(blocks, right, inner));
}

}  // namespace

EnvironmentTree::EnvironmentTree(const PackedCloud& cloud)
    : cloud_(cloud), cells_(cloud.cells()), blocks_per_cell_(cloud.blocks_per_cell()) {}

void EnvironmentTree::fill_inner_boxes(std::uint32_t cell, std::span<BlockBox> inner) const {
  unite_blocks(cloud_.blocks(cell), this->cell(cell), inner);
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
  return halves(node);
}

Box EnvironmentTree::box(const EnvironmentNode& node, std::span<const BlockBox> inner) const {
  const Quantisation& quantisation = cloud_.quantisation();
  if (node.top != EnvironmentNode::kInCell) {
    return position_box(quantisation, cloud_.tree()[node.top].box);
  }
  if (node.is_block()) return cloud_.block_box(node.cell, node.first_block);
  return position_box(quantisation,
                      decode_block_box(cells_[node.cell].box, inner[inner_in_cell(node)]));
}

}  // namespace clearway
