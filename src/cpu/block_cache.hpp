#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "cpu/range_kernels.hpp"

namespace clearway {

/// Decoded positions of recently used blocks: a direct-mapped cache of fixed size, one for each
/// thread.
class BlockCache {
 public:
  static constexpr std::uint32_t kEntries = 1024;  // 1.5 MiB

  explicit BlockCache(const PackedCloud& cloud);

  /// Positions of the block's `count` points; valid until the next call. Throws InputError if the
  /// cell's bytes are damaged.
  Columns block(std::uint32_t cell, std::uint32_t block, std::uint32_t count);

  std::uint64_t allocated_bytes() const {
    return tags_.size() * sizeof(std::uint64_t) + entries_.size() * sizeof(Positions);
  }

 private:
  struct Positions {
    alignas(64) double axes[3][kBlockPoints];
  };

  void decode(std::uint32_t cell, std::uint32_t block, std::uint32_t count, Positions& out);

  static constexpr std::uint64_t kNothing = ~std::uint64_t{0};

  const PackedCloud& cloud_;
  std::vector<std::uint64_t> tags_;
  std::vector<Positions> entries_;
  std::uint32_t open_cell_ = 0xffffffff;  ///< the cell that chunks_ belong to
  std::array<PackedChunk<std::int32_t>, 3> chunks_;
};

}  // namespace clearway
