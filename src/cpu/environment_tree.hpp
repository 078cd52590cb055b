#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/cloud/packed_cloud.hpp"
#include "core/geometry/box.hpp"

namespace clearway {

/// A node of the environment's k-d tree: several cells (an inner node of PackedCloud::tree()), or a
/// run of blocks of one cell, whose tree is implicit.
struct EnvironmentNode {
  static constexpr std::uint32_t kInCell = 0xffffffff;

  std::uint32_t top;  ///< index in PackedCloud::tree(), or kInCell
  std::uint32_t cell;
  std::uint32_t first_block;
  std::uint32_t block_count;

  bool is_block() const { return top == kInCell && block_count == 1; }
};

/// The whole k-d tree of a cloud, from all cells down to blocks. It keeps neither points nor boxes;
/// its users keep the boxes of the inner nodes of some cells. The cloud must outlive it.
class EnvironmentTree {
 public:
  explicit EnvironmentTree(const PackedCloud& cloud);

  const PackedCloud& cloud() const { return cloud_; }
  EnvironmentNode root() const { return from_top(0); }
  EnvironmentNode cell(std::uint32_t cell) const;

  /// The two halves of a node that is not a block.
  std::array<EnvironmentNode, 2> children(const EnvironmentNode& node) const;

  /// A box that holds every point of the node. inner: what fill_inner_boxes() has filled for the
  /// node's cell; it is not read if the node is a block or several cells.
  Box box(const EnvironmentNode& node, std::span<const BlockBox> inner) const;
  /// Fills the boxes of the inner nodes of a cell. inner: a box for each block of a full cell.
  void fill_inner_boxes(std::uint32_t cell, std::span<BlockBox> inner) const;

  /// Upper bound on the number of points of the node.
  std::uint64_t most_points(const EnvironmentNode& node) const {
    if (node.top == EnvironmentNode::kInCell) return std::uint64_t{node.block_count} * kBlockPoints;
    return std::uint64_t{cloud_.tree()[node.top].cell_count} * cloud_.cell_entries();
  }

  /// A number below the blocks of a full cell that no other inner node of the cell has.
  static std::uint64_t inner_in_cell(const EnvironmentNode& node) {
    return node.first_block + left_count(node.block_count, 1);
  }
  /// Index of a block among those of all cells.
  std::uint64_t block_index(std::uint32_t cell, std::uint32_t block) const {
    return std::uint64_t{cell} * blocks_per_cell_ + block;
  }

  std::uint32_t points_in_block(std::uint32_t cell, std::uint32_t block) const {
    const std::uint32_t rest = cells_[cell].count - block * kBlockPoints;
    return rest < kBlockPoints ? rest : kBlockPoints;
  }

 private:
  EnvironmentNode from_top(std::uint32_t index) const;

  const PackedCloud& cloud_;
  std::span<const Cell> cells_;
  std::uint32_t blocks_per_cell_;
};

}  // namespace clearway
