#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "io/store/class_index.hpp"
#include "io/store/store_layout.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {

/// Everything in a store except the chunks of its points.
struct StoreIndex {
  StoreMetadata metadata;
  CellIndex cells;
  ClassIndex classes;  ///< empty where the store has none
  std::vector<TopNode> top;
  std::vector<BlockBox> blocks;  ///< the same number of block boxes for every cell
};

/// Reads the index of a store, whose file has `file_bytes` bytes, and checks it against its hash.
/// Throws InputError when the file is not a complete store of this version with an intact index, or
/// when another tool rewrote it.
StoreIndex read_store_index(const std::filesystem::path& path, std::uint64_t file_bytes);

}  // namespace clearway
