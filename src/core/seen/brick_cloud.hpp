#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/seen/cubes.hpp"

namespace clearway {

/// The middles of all cubes of some bricks as a cloud that an engine can search. Each brick is a
/// cell, and a cube's number in its brick is its index in the cell. The middle of cube i is by
/// definition fl(fl((side * i + side / 2) * scale) + offset); the cloud has half the store's scale,
/// so that twice that number is an integer and the rounding stays the same.
class BrickCloud final : public PackedCloud {
 public:
  /// bricks: distinct. quantisation: the store's. Throws InputError where a middle is beyond 32-bit
  /// integers of half the scale.
  BrickCloud(std::vector<Brick> bricks, const CubeLattice& lattice,
             const Quantisation& quantisation);

  /// The bricks, in the order of the cells.
  const std::vector<Brick>& bricks() const { return bricks_; }

  std::uint64_t point_count() const override {
    return std::uint64_t{kBrickEntries} * bricks_.size();
  }
  std::uint32_t cell_points() const override { return kBrickEntries; }
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
  /// Numbers the middles by their entries.
  std::uint64_t source_of(std::uint32_t cell, std::uint32_t index) const override {
    return std::uint64_t{cell} * kBrickEntries + index;
  }
  std::uint64_t allocated_bytes() const override;

  /// Bytes of memory for this many bricks.
  static std::uint64_t bytes_for(std::uint64_t bricks) {
    return bricks *
           (sizeof(Brick) + sizeof(Cell) + 2 * sizeof(TreeNode) + kBrickWords * sizeof(BlockBox));
  }

 private:
  std::int32_t least(std::uint32_t cell, std::size_t axis) const {
    return cells_[cell].box.lo[axis];
  }

  std::vector<Brick> bricks_;
  Quantisation quantisation_{};
  std::vector<Cell> cells_;
  std::vector<TreeNode> tree_;
  std::vector<BlockBox> blocks_;
  /// For each axis the packed chunk of a brick whose least value is 0: all bricks have its payload.
  std::array<std::vector<std::byte>, 3> chunks_;
};

/// All bricks that have a cube whose middle may be closer than `radius` to what the query moves,
/// and others around them; by box of the model at each pose or on each way. Ascending. Throws
/// InputError where a cube is beyond 32-bit integers, and ResourceError where the bricks take more
/// than most_bytes.
std::vector<Brick> bricks_along(const Query& query, double radius, const CubeLattice& lattice,
                                const Quantisation& quantisation, std::uint64_t most_bytes);

}  // namespace clearway
