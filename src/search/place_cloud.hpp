#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "findings/group/cell_grid.hpp"

namespace clearway {

/// Some points in memory as a cloud that an engine can search.
class PlaceCloud final : public PackedCloud {
 public:
  static constexpr std::uint32_t kCellPoints = 512;

  PlaceCloud(std::span<const QuantumPoint> points, const Quantisation& quantisation);

  std::uint64_t point_count() const override { return point_count_; }
  std::uint32_t cell_points() const override { return kCellPoints; }
  const Quantisation& quantisation() const override { return quantisation_; }
  std::span<const Cell> cells() const override { return cells_; }
  std::span<const TreeNode> tree() const override { return tree_; }
  std::span<const BlockBox> blocks() const override { return blocks_; }
  std::array<PackedChunk<std::int32_t>, 3> coordinates(std::uint32_t cell) const override;
  std::uint64_t packed_bytes(std::uint32_t cell) const override;
  std::array<PackedChunk<std::int32_t>, 3> read_packed(std::uint32_t cell,
                                                       std::span<std::byte> to) const override;
  /// The index of a point among those of the constructor.
  std::uint64_t source_of(std::uint32_t cell, std::uint32_t index) const override {
    return sources_[std::uint64_t{cell} * kCellPoints + index];
  }

 private:
  struct Point {
    std::int32_t q[3];
    std::uint64_t source;
  };

  static QuantumBox box_of(std::span<const Point> points);
  static void order(std::span<Point> points, std::uint64_t unit);
  void add_cell(std::span<Point> points);

  std::uint64_t point_count_;
  Quantisation quantisation_;
  std::vector<Cell> cells_;
  std::vector<TreeNode> tree_;
  std::vector<BlockBox> blocks_;
  std::vector<std::uint64_t> sources_;
  std::vector<std::array<std::vector<std::byte>, 3>> chunks_;
};

}  // namespace clearway
