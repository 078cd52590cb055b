#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "clearway/store.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "io/files/mapped_file.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {

/// Everything in a store except the chunks of its points.
struct StoreIndex {
  StoreMetadata metadata;
  std::vector<Cell> cells;
  ChunkIndexes chunks;
  std::vector<TopNode> top;
};

/// A store opened for reading: its index in memory, its points in a read-only map of the file.
/// Throws InputError when the file is not an intact, complete store of this version, or when
/// another tool rewrote it.
class StoreReader final : public PackedCloud {
 public:
  explicit StoreReader(const std::filesystem::path& path);

  const StoreMetadata& metadata() const { return index_.metadata; }
  const std::string& name() const { return map_.name(); }
  /// Where the chunks are.
  const ChunkIndexes& chunks() const { return index_.chunks; }
  std::span<const TopNode> top_tree() const { return index_.top; }

  /// Hash of the cells' hashes and of everything else in the store but its points, so that two
  /// files are recognised as the same store without reading their points.
  std::uint64_t fingerprint() const;

  /// The packed source indices of a cell, checked against their hash at the first call for it.
  PackedChunk<std::uint64_t> sources(std::uint32_t cell) const;

  /// The packed classes of a cell, checked against their hash at the first call for it. Only where
  /// has_classes().
  PackedChunk<std::uint8_t> classes(std::uint32_t cell) const override;
  bool has_classes() const override { return metadata().classes.has_value(); }

  /// Whether any point has an origin, the place of the scanner that saw it.
  bool has_origins() const { return metadata().origins.has_value(); }
  /// The packed numbers of the origins of a cell, checked against their hash at the first call for
  /// it: for each point 1 + the index of its origin in metadata().origins->quanta, or 0 where it
  /// has none. Only where has_origins().
  PackedChunk<std::uint32_t> origins(std::uint32_t cell) const;

  // PackedCloud
  std::uint64_t point_count() const override { return metadata().point_count; }
  std::uint32_t cell_points() const override { return metadata().cell_points; }
  const Quantisation& quantisation() const override { return metadata().quantisation; }
  std::span<const Cell> cells() const override { return index_.cells; }
  std::span<const TreeNode> tree() const override { return tree_; }
  BlockBoxes blocks(std::uint32_t cell) const override;
  std::array<PackedChunk<std::int32_t>, 3> coordinates(std::uint32_t cell) const override;
  std::array<PackedChunk<std::int32_t>, 3> peek(std::uint32_t cell) const override;
  std::array<PackedChunk<std::int32_t>, 3> coordinates_of_block(std::uint32_t cell) const override;
  std::uint64_t packed_bytes(std::uint32_t cell) const override;
  /// The source index of a point of a cell, by sources().
  std::uint64_t source_of(std::uint32_t cell, std::uint32_t index) const override;
  /// Reads the packed coordinates of a cell into `to` from the file, not from the map; in one call
  /// where x, y and z are adjacent in the file. They are checked against their hash at the first
  /// call for the cell.
  std::array<PackedChunk<std::int32_t>, 3> read_packed(std::uint32_t cell,
                                                       std::span<std::byte> to) const override;
  /// The coordinates in the map, except those at the very end of the file.
  std::optional<std::array<PackedChunk<std::int32_t>, 3>> in_place(
      std::uint32_t cell) const override;

  /// The position of a point by its index in its cell, without the rest of the cell.
  Vec3 position_of(std::uint32_t cell, std::uint32_t index) const;
  /// The class of a point by its index in its cell. Only where has_classes().
  std::uint8_t class_of(std::uint32_t cell, std::uint32_t index) const;

  /// Number of cells whose coordinates were requested or read since the store was opened, except by
  /// peek().
  std::uint64_t cells_touched() const;
  /// Bytes that were handed out since the store was opened, by peek() too: the packed bytes of
  /// whole cells, their share of blocks, and the values of single points.
  BytesRead bytes_read() const;

  Box bounds() const override;
  /// Found at the first call.
  double typical_block() const override;

  /// Bytes of memory that the index occupies.
  std::uint64_t allocated_bytes() const override;

  /// Throws InputError where the path no longer names the file that was opened, or that file was
  /// written to or shortened since.
  void check_unchanged() const;

  /// Lets the program go on where the file shrinks or fails while it is read: reading goes on over
  /// zeros, and check_read() then throws.
  void survive_faults() const { map_.survive_faults(); }
  /// Throws InputError where something of the file could not be read since survive_faults().
  void check_read() const;

 private:
  void check_hash(std::size_t column, std::uint32_t cell, std::span<const std::byte> bytes) const;
  std::span<const std::byte> checked_bytes(std::size_t column, std::uint32_t cell) const;
  template <typename Number>
  PackedChunk<Number> chunk(std::size_t column, std::uint32_t cell,
                            std::span<const std::byte> bytes) const;
  template <typename Number>
  PackedChunk<Number> mapped(std::size_t column, std::uint32_t cell) const;
  std::array<PackedChunk<std::int32_t>, 3> mapped_coordinates(std::uint32_t cell) const;

  MappedFile map_;
  const File::Stamp stamp_ = map_.file().stamp();
  StoreIndex index_;
  std::vector<TreeNode> tree_;
  mutable std::once_flag typical_block_found_;
  mutable double typical_block_ = 0;
  /// Per cell: 1 once the hashes in the map were found right, of x, y and z together, and of
  /// source, blocks, class and origin; empty for columns that the store lacks.
  mutable std::array<std::vector<std::uint8_t>, 5> checked_;
  /// Per cell: 1 once read_packed() read its coordinates from the file.
  mutable std::vector<std::uint8_t> read_;

  /// The bytes of one column that were handed out.
  struct Counter {
    std::atomic<std::uint64_t> bytes = 0;
    void add(std::uint64_t more) { bytes.fetch_add(more, std::memory_order_relaxed); }
  };
  struct {
    Counter coordinates, sources, classes, origins;
  } mutable handed_out_;
};

}  // namespace clearway
