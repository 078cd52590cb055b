#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "core/page/page.hpp"

namespace clearway {

using Quantum = std::array<std::int32_t, 3>;

struct MemoryCloudOptions {
  std::uint32_t cell_points = 65536;
  /// Buckets of the explicit top tree hold at most this many points where they can be split by a
  /// plane; 0: one bucket. Every bucket's last cell may be short.
  std::uint64_t bucket_points = 0;
};

/// A PackedCloud in memory, for tests and benchmarks. It makes the k-d order, boxes and packed
/// chunks that a store has, all at once.
class MemoryCloud final : public PackedCloud {
 public:
  MemoryCloud(std::span<const Quantum> points, const Quantisation& quantisation,
              const MemoryCloudOptions& options = {});
  /// A cloud of points with classes. classes: one for each point.
  MemoryCloud(std::span<const Quantum> points, std::span<const std::uint8_t> classes,
              const Quantisation& quantisation, const MemoryCloudOptions& options = {});

  std::uint64_t point_count() const override { return point_count_; }
  std::uint32_t cell_points() const override { return cell_points_; }
  const Quantisation& quantisation() const override { return quantisation_; }
  std::span<const Cell> cells() const override { return cells_; }
  std::span<const TreeNode> tree() const override { return tree_; }
  std::span<const BlockBox> blocks() const override { return blocks_; }
  std::array<PackedChunk<std::int32_t>, 3> coordinates(std::uint32_t cell) const override;
  std::uint64_t packed_bytes(std::uint32_t cell) const override;
  std::array<PackedChunk<std::int32_t>, 3> read_packed(std::uint32_t cell,
                                                       std::span<std::byte> to) const override;

  /// Every second cell, so that engines get cells both in place and copied.
  std::optional<std::array<PackedChunk<std::int32_t>, 3>> in_place(
      std::uint32_t cell) const override {
    if (cell % 2 == 1) return std::nullopt;
    return coordinates(cell);
  }

  bool has_classes() const override { return !classes_.empty(); }
  PackedChunk<std::uint8_t> classes(std::uint32_t cell) const override {
    return {classes_[cell], cell_points_};
  }

  std::uint64_t source_of(std::uint32_t cell, std::uint32_t index) const override {
    return source(std::uint64_t{cell} * cell_entries() + index);
  }

  /// The index, in the constructor's points, of the point at an entry that is used.
  std::uint64_t source(std::uint64_t slot) const { return sources_[slot]; }
  bool is_used(std::uint64_t slot) const {
    return slot % cell_entries() < cells_[slot / cell_entries()].count;
  }

  /// Makes coordinates(cell) throw InputError from now on, as for a damaged store.
  void damage(std::uint32_t cell) { damaged_cell_ = cell; }

 private:
  struct Point {
    Quantum q;
    std::uint64_t source;
  };

  void add_top(std::span<Point> points, std::uint64_t bucket_points);
  void add_cells(std::span<Point> points);
  void add_cell(std::span<Point> points);

  Quantisation quantisation_;
  std::uint64_t point_count_;
  std::uint32_t cell_points_;
  std::vector<TopNode> top_;
  std::vector<Cell> cells_;
  std::vector<TreeNode> tree_;
  std::vector<BlockBox> blocks_;
  std::vector<std::uint64_t> sources_;
  /// The packed bytes of x, y and z of a cell, which others follow that a decoder may read.
  std::span<const std::byte> packed(std::uint32_t cell, std::size_t axis) const {
    const std::vector<std::byte>& bytes = chunks_[cell][axis];
    return std::span(bytes).first(bytes.size() - kPagePadding);
  }

  std::vector<std::array<std::vector<std::byte>, 3>> chunks_;
  std::vector<std::vector<std::byte>> classes_;  ///< one chunk for each cell
  std::uint32_t damaged_cell_ = 0xffffffff;
};

/// The positions of quanta, as the store defines them.
std::vector<Vec3> positions_of(std::span<const Quantum> points, const Quantisation& quantisation);

/// The quanta that are nearest to the points.
std::vector<Quantum> quantise(std::span<const Vec3> points, const Quantisation& quantisation);

}  // namespace clearway
