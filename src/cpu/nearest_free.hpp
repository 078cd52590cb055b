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
/// not ignored (docs/design/pipeline.md). Knows for each node of the tree whether it has any.
class FreePoints {
 public:
  /// The tree must outlive this object. cells: those in which points may not be free, each once; of
  /// all others every point is.
  FreePoints(const EnvironmentTree& tree, std::span<const std::uint32_t> cells);

  /// Finds the free points of one of these cells. taken: the points that collide, with a floor or
  /// without it, bit i of word w being point 64 w + i; words at the end may be missing. Different
  /// cells may be added at the same time. Throws InputError for a damaged cell.
  void add_cell(std::uint32_t cell, std::span<const std::uint64_t> taken,
                const IgnoredPoints& ignored);
  /// Called when all of these cells were added.
  void finish();

  /// Whether the node has a free point.
  bool any(const EnvironmentNode& node) const {
    if (node.top != EnvironmentNode::kInCell) return top_[node.top] != 0;
    if (places_[node.cell] == kAll) return true;
    if (node.block_count > 1) return inner_[inner_place(node)] != 0;
    return word(node.cell, node.first_block) != 0;
  }
  /// The free points of a block: bit i is set for point i.
  std::uint64_t word(std::uint32_t cell, std::uint32_t block) const {
    if (places_[cell] == kAll) {
      return ~std::uint64_t{0} >> (kBlockPoints - tree_.points_in_block(cell, block));
    }
    return words_[first_word(cell) + block];
  }

  /// Bytes of memory besides the tree, where so many cells may have points that are not free.
  static std::uint64_t bytes(const PackedCloud& cloud, std::uint64_t cells) {
    return cells * cloud.blocks_per_cell() * (sizeof(std::uint64_t) + 1) + cloud.tree().size() +
           cloud.cells().size() * sizeof(std::uint32_t);
  }

 private:
  static constexpr std::uint32_t kAll = 0xffffffff;

  bool mark(const EnvironmentNode& node);
  std::size_t first_word(std::uint32_t cell) const {
    return std::size_t{places_[cell]} * tree_.cloud().blocks_per_cell();
  }
  std::size_t inner_place(const EnvironmentNode& node) const {
    return first_word(node.cell) + EnvironmentTree::inner_in_cell(node);
  }

  const EnvironmentTree& tree_;
  std::vector<std::uint32_t> places_;  ///< of each cell its number among `cells`, or kAll
  std::vector<std::uint64_t> words_;
  std::vector<std::uint8_t> inner_;  ///< 1 for an inner node of a cell that has a free point
  std::vector<std::uint8_t> top_;    ///< the same for nodes of several cells
};

/// Finds the nearest free points of the points of one block after another, by branch and bound over
/// the tree, best first, until no node is nearer than the farthest nearest point so far. No slack
/// is needed, because least_squared_distance() of a box rounds as d2 does and monotonically
/// (docs/design/numerics.md, "Boxes"). Nodes at exactly the least distance are searched too, since
/// the smallest source decides there, so no order of work changes an answer. For one thread.
class NearestFree {
 public:
  /// Both must outlive this object.
  NearestFree(const EnvironmentTree& tree, const FreePoints& free);

  /// Sets found[i] for each point i of the block whose bit is set in `points`. Throws InputError
  /// for a damaged cell.
  void search(std::uint32_t cell, std::uint32_t block, std::uint64_t points,
              std::span<Depth, kBlockPoints> found);

  /// Bytes of memory that one of these takes, with some room for its queue.
  static std::uint64_t bytes(const PackedCloud& cloud) {
    return (std::uint64_t{512} << 10) + kKeptCells * cloud.blocks_per_cell() * sizeof(BlockBox);
  }

 private:
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  /// Blocks whose free points are kept decoded, by their index in the cloud.
  static constexpr std::size_t kKept = 256;
  /// Cells whose inner boxes are kept, by their index in the cloud.
  static constexpr std::size_t kKeptCells = 32;

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
  Box box_of(const EnvironmentNode& node);
  std::uint64_t source_of(std::uint64_t entry) const;

  const EnvironmentTree& tree_;
  const PackedCloud& cloud_;
  const FreePoints& free_;
  std::unique_ptr<std::array<FreeBlock, kKept>> kept_;
  std::array<std::uint32_t, kKeptCells> box_cells_;  ///< cells whose boxes are kept
  std::vector<BlockBox> boxes_;                      ///< those of each of them, one after the other
  std::vector<Asked> asked_;
  std::vector<Open> open_;
};

}  // namespace clearway
