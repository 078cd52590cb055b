#include "core/cloud/cell_tree.hpp"

#include "clearway/error.hpp"
#include "core/cloud/kd_order.hpp"

namespace clearway {
namespace {

class Builder {
 public:
  Builder(std::span<const TopNode> top, std::span<const Cell> cells) : top_(top), cells_(cells) {
    nodes_.reserve(2 * cells.size());
  }

  std::vector<TreeNode> build() {
    if (top_.empty() != cells_.empty()) fail();
    if (top_.empty()) return {};
    if (top_[0].first_cell != 0 || top_[0].cell_count != cells_.size()) fail();
    const std::uint32_t visited = add_top(0, 0);
    if (visited != top_.size()) fail();
    return std::move(nodes_);
  }

 private:
  static constexpr unsigned kDeepest = 256;  // far beyond what 2^32 cells need

  [[noreturn]] static void fail() {
    throw InputError("the tree of cells is inconsistent, expected a binary tree in preorder");
  }

  /// Adds the subtree of top node `index`; returns the index after its last top node.
  std::uint32_t add_top(std::uint32_t index, unsigned depth) {
    const TopNode node = top_[index];
    if (depth > kDeepest || node.cell_count == 0) fail();
    if (node.right == 0) {
      add_bucket(node.first_cell, node.cell_count);
      return index + 1;
    }
    if (node.right <= index + 1 || node.right >= top_.size()) fail();
    const TopNode left = top_[index + 1];
    const TopNode right = top_[node.right];
    if (left.first_cell != node.first_cell || left.cell_count >= node.cell_count ||
        right.first_cell != left.first_cell + left.cell_count ||
        right.cell_count != node.cell_count - left.cell_count) {
      fail();
    }
    const std::size_t self = open(node.first_cell, node.cell_count);
    if (add_top(index + 1, depth + 1) != node.right) fail();
    const auto right_node = static_cast<std::uint32_t>(nodes_.size());
    const std::uint32_t next = add_top(node.right, depth + 1);
    close(self, right_node);
    return next;
  }

  void add_bucket(std::uint32_t first, std::uint32_t count) {
    if (count == 1) {
      nodes_.push_back({first, 1, 0, cells_[first].box});
      return;
    }
    const std::size_t self = open(first, count);
    const auto left = static_cast<std::uint32_t>(left_count(count, 1));
    add_bucket(first, left);
    const auto right_node = static_cast<std::uint32_t>(nodes_.size());
    add_bucket(first + left, count - left);
    close(self, right_node);
  }

  std::size_t open(std::uint32_t first, std::uint32_t count) {
    nodes_.push_back({first, count, 0, {}});
    return nodes_.size() - 1;
  }

  void close(std::size_t self, std::uint32_t right) {
    nodes_[self].right = right;
    nodes_[self].box = nodes_[self + 1].box.united(nodes_[right].box);
  }

  std::span<const TopNode> top_;
  std::span<const Cell> cells_;
  std::vector<TreeNode> nodes_;
};

}  // namespace

std::vector<TreeNode> build_cell_tree(std::span<const TopNode> top, std::span<const Cell> cells) {
  return Builder(top, cells).build();
}

}  // namespace clearway
