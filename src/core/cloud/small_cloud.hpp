#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "core/page/page.hpp"

namespace clearway {

/// A point in the steps of a quantisation.
using Quantum = std::array<std::int32_t, 3>;

/// A cloud of some points in memory, with the k-d order, boxes and packed chunks that a store has.
class SmallCloud : public PackedCloud {
 public:
  struct Packing {
    std::uint32_t cell_points = 65536;
    /// Buckets of the explicit top tree hold at most this many points where they can be split by a
    /// plane; 0: one bucket. Every bucket's last cell may be short.
    std::uint64_t bucket_points = 0;
  };

  SmallCloud(std::span<const Quantum> points, const Quantisation& quantisation,
             const Packing& packing);

  std::uint64_t point_count() const override { return point_count_; }
  std::uint32_t cell_points() const override { return cell_points_; }
  const Quantisation& quantisation() const override { return quantisation_; }
  std::span<const Cell> cells() const override { return cells_; }
  std::span<const TreeNode> tree() const override { return tree_; }
  BlockBoxes blocks(std::uint32_t cell) const override {
    return BlockBoxes(std::as_bytes(
        std::span(blocks_).subspan(std::size_t{cell} * blocks_per_cell(), blocks_per_cell())));
  }
  std::array<PackedChunk<std::int32_t>, 3> coordinates(std::uint32_t cell) const override;
  std::uint64_t packed_bytes(std::uint32_t cell) const override;
  std::array<PackedChunk<std::int32_t>, 3> read_packed(std::uint32_t cell,
                                                       std::span<std::byte> to) const override;
  std::optional<std::array<PackedChunk<std::int32_t>, 3>> in_place(
      std::uint32_t cell) const override {
    return coordinates(cell);
  }
  std::uint64_t source_of(std::uint32_t cell, std::uint32_t index) const override {
    return source(std::uint64_t{cell} * cell_entries() + index);
  }

  /// The index, in the constructor's points, of the point at an entry that is used.
  std::uint64_t source(std::uint64_t entry) const { return sources_[entry]; }

 private:
  struct Point {
    Quantum q;
    std::uint64_t source;
  };

  void add_top(std::span<Point> points, std::uint64_t bucket_points);
  void add_cells(std::span<Point> points);
  void add_cell(std::span<Point> points);

  /// The packed bytes of x, y and z of a cell, which others follow that a decoder may read.
  std::span<const std::byte> packed(std::uint32_t cell, std::size_t axis) const {
    const std::vector<std::byte>& bytes = chunks_[cell][axis];
    return std::span(bytes).first(bytes.size() - kPagePadding);
  }

  Quantisation quantisation_;
  std::uint64_t point_count_;
  std::uint32_t cell_points_;
  std::vector<TopNode> top_;
  std::vector<Cell> cells_;
  std::vector<TreeNode> tree_;
  std::vector<BlockBox> blocks_;
  std::vector<std::uint64_t> sources_;
  std::vector<std::array<std::vector<std::byte>, 3>> chunks_;
};

}  // namespace clearway
