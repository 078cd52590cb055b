#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/result/column_hashes.hpp"

/// Names and tables that the store's writer and reader share (docs/design/store-format.md).
namespace clearway {

inline const std::string kStoreFormat = "clearway store";
inline constexpr std::uint32_t kMostCellPoints = 1U << 20;
inline constexpr const char* kPointDatasets[4] = {"x", "y", "z", "source"};

/// Dataset of /sources; only where there are several files.
inline constexpr const char* kSourcePoints = "points";

/// The datasets of /cells, row-major. Each cell has four chunks: x, y, z, source.
struct CellIndex {
  std::vector<std::uint32_t> count;    // [cells]
  std::vector<std::int32_t> box;       // [cells, 6]
  std::vector<std::uint64_t> address;  // [cells, 4]
  std::vector<std::uint32_t> bytes;    // [cells, 4]
  std::vector<std::uint64_t> xxh64;    // [cells, 4]
};

inline void add_index(const CellIndex& index, ColumnHashes& hashes) {
  hashes.add(index.count);
  hashes.add(index.box);
  hashes.add(index.address);
  hashes.add(index.bytes);
  hashes.add(index.xxh64);
}

}  // namespace clearway
