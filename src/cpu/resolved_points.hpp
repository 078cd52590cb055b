#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "core/query/search_result.hpp"
#include "cpu/environment_tree.hpp"

namespace clearway {

/// Records which points and nodes need not be searched again. A point is *resolved at* pose i if no
/// pose from i on can change its answer: it is marked (sets), or marked with a pose <= i (first
/// poses). A node is known to be resolved only if resolve_node() was called for it. Thread safe.
class ResolvedPoints {
 public:
  ResolvedPoints(const EnvironmentTree& tree, HitSet& hits)
      : tree_(tree), hits_(hits), first_pose_(hits.has_first_pose()) {
    if (first_pose_) {
      inner_pose_.assign(tree.node_slots(), HitSet::kNever);
      block_pose_.assign(tree.node_slots(), HitSet::kNever);
    } else {
      inner_done_.assign(tree.node_slots(), 0);
    }
    top_pose_.assign(tree.cloud().tree().size(), HitSet::kNever);
  }

  bool first_pose() const { return first_pose_; }

  /// True only if every point of the node is resolved at `pose`; may be false although they all
  /// are.
  bool node_resolved(const EnvironmentNode& node, std::uint32_t pose) {
    if (node.top != EnvironmentNode::kInCell) return load(top_pose_[node.top]) <= pose;
    if (node.block_count > 1) {
      const std::uint64_t index = tree_.inner_index(node);
      return first_pose_ ? load(inner_pose_[index]) <= pose : load(inner_done_[index]) != 0;
    }
    const std::uint64_t index = tree_.block_index(node.cell, node.first_block);
    if (first_pose_) return load(block_pose_[index]) <= pose;
    const std::uint64_t all = all_points(node.cell, node.first_block);
    return (hits_.word_now(index) & all) == all;
  }

  /// Records that every point of the node is resolved at `pose`.
  void resolve_node(const EnvironmentNode& node, std::uint32_t pose) {
    if (node.top != EnvironmentNode::kInCell) {
      store(top_pose_[node.top], first_pose_ ? pose : 0);
    } else if (node.block_count > 1) {
      const std::uint64_t index = tree_.inner_index(node);
      if (first_pose_) {
        store(inner_pose_[index], pose);
      } else {
        store(inner_done_[index], std::uint8_t{1});
      }
    } else if (first_pose_) {
      store(block_pose_[tree_.block_index(node.cell, node.first_block)], pose);
    }
  }

  /// Records that the cells for which skip(cell) is true need no search, and neither do the nodes
  /// that have only such cells. A cell of a single block is searched nevertheless if no first poses
  /// are asked for.
  template <typename Skip>
  void leave_out(const Skip& skip) {
    const std::span<const TreeNode> nodes = tree_.cloud().tree();
    // From the last to the first, because children come after their parents
    for (std::size_t i = nodes.size(); i-- > 0;) {
      if (nodes[i].right == 0) {
        const std::uint32_t cell = nodes[i].first_cell;
        if (skip(cell)) resolve_node(tree_.cell(cell), 0);
      }
      const std::uint32_t first = nodes[i].first_cell, end = first + nodes[i].cell_count;
      bool all = true;
      for (std::uint32_t cell = first; cell < end && all; ++cell) all = skip(cell);
      if (all) store(top_pose_[i], std::uint32_t{0});
    }
  }

  bool point_resolved(std::uint64_t slot, std::uint32_t pose) {
    if (first_pose_) return hits_.first_pose_now(slot) <= pose;
    return (hits_.word_now(slot / 64) >> (slot % 64) & 1) != 0;
  }

  /// The points of a block that are not resolved at `pose`: bit i is set for point i.
  std::uint64_t open_points(std::uint32_t cell, std::uint32_t block, std::uint32_t pose) {
    const std::uint64_t index = tree_.block_index(cell, block);
    const std::uint64_t all = all_points(cell, block);
    if (!first_pose_) return ~hits_.word_now(index) & all;
    std::uint64_t open = 0;
    for (std::uint32_t i = 0; i < tree_.points_in_block(cell, block); ++i) {
      open |= std::uint64_t{hits_.first_pose_now(index * kBlockPoints + i) > pose} << i;
    }
    return open;
  }

  void mark(std::uint64_t slot, std::uint32_t pose) {
    if (first_pose_) {
      hits_.mark(slot, pose);
    } else {
      hits_.mark(slot);
    }
  }

  /// Marks every point of the node with `pose`, and calls visit(word, bits) for each block that is
  /// marked.
  template <typename Visit>
  void mark_node(const EnvironmentNode& node, std::uint32_t pose, const Visit& visit) {
    if (node_resolved(node, pose)) return;
    if (!node.is_block()) {
      for (const EnvironmentNode& child : tree_.children(node)) mark_node(child, pose, visit);
      resolve_node(node, pose);
      return;
    }
    const std::uint64_t index = tree_.block_index(node.cell, node.first_block);
    visit(index, all_points(node.cell, node.first_block));
    if (!first_pose_) return hits_.mark_word(index, all_points(node.cell, node.first_block));
    for (std::uint32_t i = 0; i < tree_.points_in_block(node.cell, node.first_block); ++i) {
      hits_.mark(index * kBlockPoints + i, pose);
    }
    resolve_node(node, pose);
  }

  std::uint64_t allocated_bytes() const {
    return inner_done_.capacity() +
           sizeof(std::uint32_t) *
               (inner_pose_.capacity() + block_pose_.capacity() + top_pose_.capacity());
  }

 private:
  template <typename Value>
  static Value load(Value& value) {
    return std::atomic_ref(value).load(std::memory_order_relaxed);
  }
  template <typename Value>
  static void store(Value& target, Value value) {
    std::atomic_ref(target).store(value, std::memory_order_relaxed);
  }

  std::uint64_t all_points(std::uint32_t cell, std::uint32_t block) const {
    return ~std::uint64_t{0} >> (kBlockPoints - tree_.points_in_block(cell, block));
  }

  const EnvironmentTree& tree_;
  HitSet& hits_;
  bool first_pose_;
  std::vector<std::uint8_t> inner_done_;
  std::vector<std::uint32_t> inner_pose_, block_pose_, top_pose_;
};

}  // namespace clearway
