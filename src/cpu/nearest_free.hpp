#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "core/query/ignored_points.hpp"
#include "core/query/search_result.hpp"
#include "cpu/environment_tree.hpp"

namespace clearway {

/// The points of a cloud that are free: that do not collide, with a floor or without it, and are
/// not ignored (docs/design/depth.md). Knows for each node of the tree whether it has any.
class FreePoints {
 public:
  /// The tree must outlive this object.
  explicit FreePoints(const EnvironmentTree& tree);

  /// Finds the free points of a cell. taken: the points that collide, with a floor or without it,
  /// bit i of word w being point 64 w + i; words at the end may be missing. Different cells may be
  /// added at the same time. Throws InputError for a damaged cell.
  void add_cell(std::uint32_t cell, std::span<const std::uint64_t> taken,
                const IgnoredPoints& ignored);
  /// Called when all cells were added.
  void finish();

  /// Whether the node has a free point.
  bool any(const EnvironmentNode& node) const {
    if (node.top != EnvironmentNode::kInCell) return top_[node.top] != 0;
    if (node.block_count > 1) return inner_[tree_.inner_index(node)] != 0;
    return word(node.cell, node.first_block) != 0;
  }
  /// The free points of a block: bit i is set for point i.
  std::uint64_t word(std::uint32_t cell, std::uint32_t block) const {
    return words_[tree_.block_index(cell, block)];
  }

  /// Bytes of memory besides the tree.
  static std::uint64_t bytes(const PackedCloud& cloud) {
    return cloud.entry_count() / kBlockPoints * (sizeof(std::uint64_t) + 1) + cloud.tree().size();
  }

 private:
  bool mark(const EnvironmentNode& node);

  const EnvironmentTree& tree_;
  std::vector<std::uint64_t> words_;
  std::vector<std::uint8_t> inner_;  ///< 1 for an inner node of a cell that has a free point
  std::vector<std::uint8_t> top_;    ///< the same for nodes of several cells
};

/// Finds the nearest free points of the points of one block after another, by branch and bound over
/// the tree, best first. For one thread.
class NearestFree {
 public:
  /// Both must outlive this object.
  NearestFree(const EnvironmentTree& tree, const FreePoints& free);

  /// Sets found[i] for each point i of the block whose bit is set in `points`. Throws InputError
  /// for a damaged cell.
  void search(std::uint32_t cell, std::uint32_t block, std::uint64_t points,
              std::span<Depth, kBlockPoints> found);

  /// Bytes of memory that one of these takes, with some room for its queue.
  static constexpr std::uint64_t kBytes = std::uint64_t{512} << 10;

 private:
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  /// Blocks whose free points are kept decoded, by their index in the cloud.
  static constexpr std::size_t kKept = 256;

  /// The free points of a block, with places that are infinitely far up to a multiple of kLanes.
  struct FreeBlock {
    std::uint64_t index = kNone;
    std::uint32_t count = 0;
    double x[kBlockPoints], y[kBlockPoints], z[kBlockPoints];
    std::uint8_t point[kBlockPoints];  ///< index of each in the block
  };

  /// A point whose nearest free point is searched, and the nearest one so far.
  struct Asked {
    Vec3 place;
    double squared = std::numeric_limits<double>::infinity();
    std::uint64_t entry = kNone;
    std::uint64_t source = kNone;  ///< kNone until it is needed
    std::uint32_t point = 0;
  };

  struct Open {
    double squared;  ///< never above the computed d2 of any pair of points
    EnvironmentNode node;
  };

  void ask(std::uint32_t cell, std::uint32_t block, std::uint64_t points);
  void visit(const EnvironmentNode& block, const Box& box);
  void offer(Asked& asked, std::uint64_t entry) const;
  const FreeBlock& free_block(std::uint32_t cell, std::uint32_t block);
  std::uint64_t source_of(std::uint64_t entry) const;

  const EnvironmentTree& tree_;
  const PackedCloud& cloud_;
  const FreePoints& free_;
  std::unique_ptr<std::array<FreeBlock, kKept>> kept_;
  std::vector<Asked> asked_;
  std::vector<Open> open_;
};

}  // namespace clearway
