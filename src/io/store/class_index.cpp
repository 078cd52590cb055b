#include "io/store/class_index.hpp"

#include <hdf5.h>

#include <algorithm>

#include "io/files/input_error.hpp"
#include "io/files/xxh64.hpp"

namespace clearway {
namespace {

constexpr const char* kClassPoints = "points";  // number of points of each of the 256 classes

template <typename Points>
std::uint64_t hash_of(const Points& points, const ClassIndex& index) {
  ColumnHashes hashes;
  hashes.add(points);
  hashes.add(index.address);
  hashes.add(index.bytes);
  hashes.add(index.xxh64);
  return hashes.digest();
}

void check_counts(const StoreClasses& classes, std::uint64_t point_count, const std::string& name) {
  std::uint64_t left = point_count;
  for (const std::uint64_t count : classes.points) {
    if (count > left) break;
    left -= count;
  }
  if (left == 0 && classes.points[0] < point_count) return;
  refuse(name, "dataset 'classes/points': expected counts that add up to point_count, " +
                   std::to_string(point_count) + ", not all of class 0");
}

}  // namespace

void ClassIndex::reserve(std::uint64_t cells) {
  address.reserve(cells);
  bytes.reserve(cells);
  xxh64.reserve(cells);
}

void ClassIndex::check(std::uint64_t file_bytes, const std::string& name) const {
  for (std::size_t i = 0; i < address.size(); ++i) {
    if (address[i] <= file_bytes && bytes[i] <= file_bytes - address[i]) continue;
    refuse(name, "cell " + std::to_string(i) +
                     " has a chunk of classes past the end of the file at byte " +
                     std::to_string(file_bytes));
  }
}

void write_class_index(const hdf5::Id& file, const StoreClasses& classes, const ClassIndex& index) {
  const hdf5::Id group = hdf5::open_group(file, kClasses, "the store");
  hdf5::write_dataset<std::uint64_t>(group, kClassPoints, classes.points);
  hdf5::write_dataset<std::uint64_t>(group, "address", index.address);
  hdf5::write_dataset<std::uint32_t>(group, "bytes", index.bytes);
  hdf5::write_dataset<std::uint64_t>(group, "xxh64", index.xxh64);
  hdf5::write_number(file, "classes_hash", classes.hash);
  hdf5::write_number(file, "classes_index_hash", hash_of(classes.points, index));
}

bool has_class_index(const hdf5::Id& file) {
  return H5Lexists(file.get(), kClasses, H5P_DEFAULT) > 0;
}

ClassIndex read_class_index(const hdf5::Id& file, const std::string& name, std::uint64_t cells,
                            StoreMetadata& metadata) {
  const hdf5::Id group = hdf5::open_group(file, kClasses, name);
  StoreClasses& classes = metadata.classes.emplace();
  const auto points =
      hdf5::read_dataset<std::uint64_t>(group, kClassPoints, classes.points.size(), 0, name);
  std::copy(points.begin(), points.end(), classes.points.begin());
  ClassIndex index;
  index.address = hdf5::read_dataset<std::uint64_t>(group, "address", cells, 0, name);
  index.bytes = hdf5::read_dataset<std::uint32_t>(group, "bytes", cells, 0, name);
  index.xxh64 = hdf5::read_dataset<std::uint64_t>(group, "xxh64", cells, 0, name);
  if (hash_of(classes.points, index) !=
      hdf5::read_number<std::uint64_t>(file, "classes_index_hash", name)) {
    refuse(name, "its index of classes is damaged (its hash is not the one recorded)");
  }
  classes.hash = hdf5::read_number<std::uint64_t>(file, "classes_hash", name);
  check_counts(classes, metadata.point_count, name);
  return index;
}

}  // namespace clearway
