#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/cloud/cell_tree.hpp"
#include "core/cloud/kd_order.hpp"
#include "core/cloud/packed_chunk.hpp"
#include "core/geometry/quantisation.hpp"
#include "core/geometry/quantum_box.hpp"

namespace clearway {

/// The environment as the engines see it: packed cells in k-d order. An *entry* is a place for a
/// point in that order: entry = cell * cell_entries() + index in the cell, so that block b of a
/// cell is 64 entries, one word of a HitSet. Entries past a cell's count are unused.
class PackedCloud {
 public:
  virtual ~PackedCloud() = default;

  virtual std::uint64_t point_count() const = 0;
  virtual std::uint32_t cell_points() const = 0;
  virtual const Quantisation& quantisation() const = 0;
  virtual std::span<const Cell> cells() const = 0;
  /// The tree over cells, in preorder, see cell_tree.hpp. Empty for an empty cloud.
  virtual std::span<const TreeNode> tree() const = 0;
  /// Block boxes of all cells, divide_up(cell_points, kBlockPoints) entries for each cell; entries
  /// of blocks past a cell's count are unused.
  virtual std::span<const BlockBox> blocks() const = 0;

  /// The packed x, y and z of a cell, which are checked against the cell's hash at the first touch.
  /// Thread safe. Throws InputError naming file and cell if the bytes are not those that were
  /// written.
  virtual std::array<PackedChunk<std::int32_t>, 3> coordinates(std::uint32_t cell) const = 0;

  /// coordinates() for a look that is no part of a search: it does not count as a touch.
  virtual std::array<PackedChunk<std::int32_t>, 3> peek(std::uint32_t cell) const {
    return coordinates(cell);
  }

  /// Size of the packed x, y and z of a cell together, bytes.
  virtual std::uint64_t packed_bytes(std::uint32_t cell) const = 0;

  /// Reads the packed x, y and z of a cell, one after another, into `to`, which has
  /// packed_bytes(cell) bytes, and checks them against the cell's hashes. The chunks returned are
  /// views of `to`. Thread safe. Throws InputError naming file and cell if the bytes are not those
  /// that were written, ResourceError if they cannot be read.
  virtual std::array<PackedChunk<std::int32_t>, 3> read_packed(std::uint32_t cell,
                                                               std::span<std::byte> to) const = 0;

  /// The source index of a point by its index in its cell. Thread safe. Throws InputError if the
  /// cell is damaged.
  virtual std::uint64_t source_of(std::uint32_t cell, std::uint32_t index) const = 0;

  /// Whether points have classes; otherwise all points have class 0.
  virtual bool has_classes() const { return false; }
  /// The packed classes of a cell, in the order of its points; only if has_classes(). Thread safe.
  /// Throws InputError if the cell is damaged.
  virtual PackedChunk<std::uint8_t> classes(std::uint32_t /*cell*/) const { return {}; }

  std::uint32_t blocks_per_cell() const {
    return static_cast<std::uint32_t>(divide_up(cell_points(), kBlockPoints));
  }
  std::uint32_t cell_entries() const { return blocks_per_cell() * kBlockPoints; }
  std::uint64_t entry_count() const { return std::uint64_t{cells().size()} * cell_entries(); }
};

/// The largest |coordinate| of the cloud's box, metres; 0 for no points.
double largest_coordinate(const PackedCloud& cloud);

}  // namespace clearway
