#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/quantum_box.hpp"

namespace clearway {

/// One cell of a store: `count` points (never 0) and their box.
struct Cell {
  std::uint32_t count;
  QuantumBox box;
};

/// A node of the explicit top of the store's k-d tree, in preorder: its left child follows it.
/// A leaf (right == 0) is a bucket, whose cells follow the split rule of kd_order.hpp.
struct TopNode {
  std::uint32_t first_cell;
  std::uint32_t cell_count;
  std::uint32_t right;  ///< index of the right child, 0 for a leaf
  friend bool operator==(const TopNode&, const TopNode&) = default;
};

/// A node of the whole tree over cells, in preorder: the left child of node i is i + 1. A leaf
/// (right == 0) is one cell.
struct TreeNode {
  std::uint32_t first_cell;
  std::uint32_t cell_count;
  std::uint32_t right;
  QuantumBox box;  ///< box around the node's points
};

/// Expands the top tree down to single cells and gives every node the box of its cells. Empty for
/// no cells. Throws InputError if `top` is not a tree over exactly these cells.
std::vector<TreeNode> build_cell_tree(std::span<const TopNode> top, std::span<const Cell> cells);

}  // namespace clearway
