#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/files/hdf5.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {

/// Names of the group of classes, in stores that have them, and of its dataset of packed classes:
/// [cells, cell_points].
inline constexpr const char* kClasses = "classes";
inline constexpr const char* kClassOfPoints = "class";

/// Address, size and hash of the packed classes of each cell; empty where the store has none.
struct ClassIndex {
  std::vector<std::uint64_t> address;
  std::vector<std::uint32_t> bytes;
  std::vector<std::uint64_t> xxh64;

  /// Reserves room for exactly this many cells.
  void reserve(std::uint64_t cells);
  /// Throws InputError where a chunk lies beyond the file's bytes. name: the file's, for messages.
  void check(std::uint64_t file_bytes, const std::string& name) const;
};

/// Writes the counts and the index of classes into the group kClasses, which exists already. They
/// have a hash of their own, because earlier releases check the index's hash without them.
void write_class_index(const hdf5::Id& file, const StoreClasses& classes, const ClassIndex& index);

bool has_class_index(const hdf5::Id& file);

/// Reads the index of classes of a store that has one, and sets metadata.classes, whose counts must
/// add up to the store's points. Throws InputError where something is damaged. name: the file's,
/// for messages.
ClassIndex read_class_index(const hdf5::Id& file, const std::string& name, std::uint64_t cells,
                            StoreMetadata& metadata);

}  // namespace clearway
