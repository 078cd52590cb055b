#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/hdf5/hdf5.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {

/// The group of the points' classes, in stores that have them, and the dataset of the packed
/// classes: [cells, cell_points].
inline constexpr const char* kClasses = "classes";
inline constexpr const char* kClassOfPoints = "class";

/// Where the packed classes of each cell are; empty where the store has none.
struct ClassIndex {
  std::vector<std::uint64_t> address;
  std::vector<std::uint32_t> bytes;
  std::vector<std::uint64_t> xxh64;

  /// So that it never takes more than it needs.
  void reserve(std::uint64_t cells);
  /// Throws InputError where a chunk lies beyond the file's bytes. name: of the file.
  void check(std::uint64_t file_bytes, const std::string& name) const;
};

/// Into the group that is there already, with a hash of its own: earlier releases know the other
/// one.
void write_class_index(const hdf5::Id& file, const StoreClasses& classes, const ClassIndex& index);

bool has_class_index(const hdf5::Id& file);

/// Of a store that has one; sets the metadata's classes, whose counts have to be those of its
/// points. Throws InputError for what is damaged. name: of the file.
ClassIndex read_class_index(const hdf5::Id& file, const std::string& name, std::uint64_t cells,
                            StoreMetadata& metadata);

}  // namespace clearway
