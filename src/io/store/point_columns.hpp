#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/files/hdf5.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {

/// A value of every point that only some stores have: its group, and the dataset of its packed
/// chunks, [cells, cell_points]. A column has hashes of its own, so that what it holds does not
/// change the hash of the index.
struct PointColumn {
  const char* group;
  const char* dataset;
};

inline constexpr PointColumn kClassColumn{"classes", "class"};
inline constexpr PointColumn kOriginColumn{"origins", "origin"};

/// Whether a store has this column.
bool has_column(const hdf5::Id& file, const PointColumn& column);

/// Address, size and hash of the packed chunk of each cell in a column; empty where the store does
/// not have the column.
struct ColumnIndex {
  std::vector<std::uint64_t> address;
  std::vector<std::uint32_t> bytes;
  std::vector<std::uint64_t> xxh64;

  /// Reserves room for exactly this many cells.
  void reserve(std::uint64_t cells);
  std::uint64_t allocated_bytes() const;
  /// Throws InputError where a chunk lies beyond the file's bytes. name: the file's, for messages.
  void check(const PointColumn& column, std::uint64_t file_bytes, const std::string& name) const;
};

/// Writes the counts and the index of classes into the group of kClassColumn, which exists already.
void write_classes(const hdf5::Id& file, const StoreClasses& classes, const ColumnIndex& index);
/// Reads the index of classes of a store that has one, and sets metadata.classes, whose counts must
/// add up to the store's points. Throws InputError where something is damaged. name: the file's,
/// for messages.
ColumnIndex read_classes(const hdf5::Id& file, const std::string& name, std::uint64_t cells,
                         StoreMetadata& metadata);

/// Writes the origins and the index of their numbers into the group of kOriginColumn, which exists
/// already.
void write_origins(const hdf5::Id& file, const StoreOrigins& origins, const ColumnIndex& index);
/// Reads the origins of a store that has them, and sets metadata.origins. Throws InputError where
/// something is damaged. name: the file's, for messages.
ColumnIndex read_origins(const hdf5::Id& file, const std::string& name, std::uint64_t cells,
                         StoreMetadata& metadata);

}  // namespace clearway
