#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "core/geometry/quantisation.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {

/// One packed cell, which the writer puts into the file as it is.
struct PackedCell {
  Cell cell;
  /// Packed values of each column, cell_points of them; empty where the store lacks the column
  std::array<std::vector<std::byte>, kPointColumns> chunks;
  std::array<std::uint64_t, kPointColumns> xxh64{};  ///< hashes of the chunks, see seal_cell()
};

/// Packs the boxes of the blocks of a cell that have points, and fills in the hashes of all chunks.
/// Called by the threads that pack, because the writer has only one.
void seal_cell(PackedCell& packed, std::span<const BlockBox> blocks, std::uint32_t cell_points);

/// Writes a store front to back. All calls come from one thread. The caller owns the file's name
/// and publishes it after finish().
class StoreWriter {
 public:
  /// cells: number of cells that will be written. Throws ResourceError.
  StoreWriter(const std::filesystem::path& path, const StoreMetadata& metadata,
              std::uint64_t cells);
  ~StoreWriter();

  void append(const PackedCell& cell);

  /// Writes the index and closes the file.
  void finish(const std::vector<TopNode>& tree);
  /// Re-reads every chunk at its recorded address, on the threads of the calling TBB arena. Called
  /// after finish(). Throws ResourceError when a chunk is not where it should be.
  void confirm() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace clearway
