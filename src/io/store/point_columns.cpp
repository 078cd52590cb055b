#include "io/store/point_columns.hpp"

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <string>

#include "io/files/input_error.hpp"
#include "io/files/xxh64.hpp"

namespace clearway {
namespace {

constexpr const char* kPoints = "points";  // numbers of points, of each class or basis

std::string attribute_of(const PointColumn& column, const char* what) {
  return std::string(column.group) + what;
}

void add(const ColumnIndex& index, ColumnHashes& hashes) {
  hashes.add(index.address);
  hashes.add(index.bytes);
  hashes.add(index.xxh64);
}

/// Writes the index of a column and its hash, which continues `hashes`.
void write_index(const hdf5::Id& file, const hdf5::Id& group, const PointColumn& column,
                 std::uint64_t hash_of_values, const ColumnIndex& index, ColumnHashes hashes) {
  hdf5::write_dataset<std::uint64_t>(group, "address", index.address);
  hdf5::write_dataset<std::uint32_t>(group, "bytes", index.bytes);
  hdf5::write_dataset<std::uint64_t>(group, "xxh64", index.xxh64);
  add(index, hashes);
  hdf5::write_number(file, attribute_of(column, "_hash").c_str(), hash_of_values);
  hdf5::write_number(file, attribute_of(column, "_index_hash").c_str(), hashes.digest());
}

/// Reads the index of a column and checks its hash, which continues `hashes`.
ColumnIndex read_index(const hdf5::Id& file, const hdf5::Id& group, const PointColumn& column,
                       const std::string& name, std::uint64_t cells, ColumnHashes hashes,
                       std::uint64_t& hash_of_values) {
  ColumnIndex index;
  index.address = hdf5::read_dataset<std::uint64_t>(group, "address", cells, 0, name);
  index.bytes = hdf5::read_dataset<std::uint32_t>(group, "bytes", cells, 0, name);
  index.xxh64 = hdf5::read_dataset<std::uint64_t>(group, "xxh64", cells, 0, name);
  add(index, hashes);
  if (hashes.digest() !=
      hdf5::read_number<std::uint64_t>(file, attribute_of(column, "_index_hash").c_str(), name)) {
    refuse(name, std::string("its index of ") + column.group +
                     " is damaged (its hash is not the one recorded)");
  }
  hash_of_values =
      hdf5::read_number<std::uint64_t>(file, attribute_of(column, "_hash").c_str(), name);
  return index;
}

}  // namespace

bool has_column(const hdf5::Id& file, const PointColumn& column) {
  return H5Lexists(file.get(), column.group, H5P_DEFAULT) > 0;
}

void ColumnIndex::reserve(std::uint64_t cells) {
  address.reserve(cells);
  bytes.reserve(cells);
  xxh64.reserve(cells);
}

std::uint64_t ColumnIndex::allocated_bytes() const {
  return (address.capacity() + xxh64.capacity()) * sizeof(std::uint64_t) +
         bytes.capacity() * sizeof(std::uint32_t);
}

void ColumnIndex::check(const PointColumn& column, std::uint64_t file_bytes,
                        const std::string& name) const {
  for (std::size_t i = 0; i < address.size(); ++i) {
    if (address[i] <= file_bytes && bytes[i] <= file_bytes - address[i]) continue;
    refuse(name, "cell " + std::to_string(i) + " has a chunk of " + column.group +
                     " past the end of the file at byte " + std::to_string(file_bytes));
  }
}

}  // namespace clearway

// Classes.

namespace clearway {
namespace {

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

void write_classes(const hdf5::Id& file, const StoreClasses& classes, const ColumnIndex& index) {
  const hdf5::Id group = hdf5::open_group(file, kClassColumn.group, "the store");
  hdf5::write_dataset<std::uint64_t>(group, kPoints, classes.points);
  ColumnHashes hashes;
  hashes.add(classes.points);
  write_index(file, group, kClassColumn, classes.hash, index, hashes);
}

ColumnIndex read_classes(const hdf5::Id& file, const std::string& name, std::uint64_t cells,
                         StoreMetadata& metadata) {
  const hdf5::Id group = hdf5::open_group(file, kClassColumn.group, name);
  StoreClasses& classes = metadata.classes.emplace();
  const auto points =
      hdf5::read_dataset<std::uint64_t>(group, kPoints, classes.points.size(), 0, name);
  std::copy(points.begin(), points.end(), classes.points.begin());
  ColumnHashes hashes;
  hashes.add(classes.points);
  ColumnIndex index = read_index(file, group, kClassColumn, name, cells, hashes, classes.hash);
  check_counts(classes, metadata.point_count, name);
  return index;
}

}  // namespace clearway

// Origins.

namespace clearway {
namespace {

constexpr const char* kQuanta = "quanta";   // the distinct origins, [origins, 3]
constexpr const char* kRestOn = "rest_on";  // texts, each ended by a zero byte

std::span<const std::int64_t> numbers_of(const std::vector<std::array<std::int64_t, 3>>& quanta) {
  return {quanta.empty() ? nullptr : quanta.front().data(), 3 * quanta.size()};
}

void check_origins(const StoreOrigins& origins, const std::string& name) {
  const auto& quanta = origins.quanta;
  constexpr std::int64_t kFarthest = std::int64_t{1} << 62;
  for (const std::int64_t q : numbers_of(quanta)) {
    if (q < -kFarthest || q > kFarthest) {
      refuse(name, "dataset 'origins/quanta': expected values from -2^62 to 2^62");
    }
  }
  if (!quanta.empty() && quanta.size() < std::numeric_limits<std::uint32_t>::max() &&
      std::adjacent_find(quanta.begin(), quanta.end(), std::greater_equal()) == quanta.end()) {
    return;
  }
  refuse(name, "dataset 'origins/quanta': expected ascending origins, one at least");
}

/// Sets what the origins rest on, and the number of points without an origin.
void read_bases(const std::vector<std::uint8_t>& texts, const std::vector<std::uint64_t>& points,
                StoreMetadata& metadata, const std::string& name) {
  StoreOrigins& origins = *metadata.origins;
  if (static_cast<std::size_t>(std::count(texts.begin(), texts.end(), 0)) != points.size()) {
    refuse(name, "dataset 'origins/rest_on': expected " + std::to_string(points.size()) + " texts");
  }
  origins.points_without = metadata.point_count;
  auto at = texts.begin();
  for (const std::uint64_t count : points) {
    const auto end = std::find(at, texts.end(), 0);
    origins.rest_on.push_back({std::string(at, end), count});
    at = end + 1;
    if (count > origins.points_without) {
      refuse(name, "dataset 'origins/points': expected counts of at most point_count, " +
                       std::to_string(metadata.point_count) + ", in all");
    }
    origins.points_without -= count;
  }
}

}  // namespace

void write_origins(const hdf5::Id& file, const StoreOrigins& origins, const ColumnIndex& index) {
  const hdf5::Id group = hdf5::open_group(file, kOriginColumn.group, "the store");
  std::vector<std::uint8_t> texts;
  std::vector<std::uint64_t> points;
  for (const OriginBasis& basis : origins.rest_on) {
    texts.insert(texts.end(), basis.what.begin(), basis.what.end());
    texts.push_back(0);
    points.push_back(basis.points);
  }
  hdf5::write_dataset<std::int64_t>(group, kQuanta, numbers_of(origins.quanta), 3);
  hdf5::write_dataset<std::uint8_t>(group, kRestOn, texts);
  hdf5::write_dataset<std::uint64_t>(group, kPoints, points);
  ColumnHashes hashes;
  hashes.add(numbers_of(origins.quanta));
  hashes.add(texts);
  hashes.add(points);
  write_index(file, group, kOriginColumn, origins.hash, index, hashes);
}

ColumnIndex read_origins(const hdf5::Id& file, const std::string& name, std::uint64_t cells,
                         StoreMetadata& metadata) {
  const hdf5::Id group = hdf5::open_group(file, kOriginColumn.group, name);
  StoreOrigins& origins = metadata.origins.emplace();
  const std::uint64_t rows = hdf5::dataset_rows(group, kQuanta, name);
  const auto quanta = hdf5::read_dataset<std::int64_t>(group, kQuanta, rows, 3, name);
  const auto texts = hdf5::read_dataset<std::uint8_t>(
      group, kRestOn, hdf5::dataset_rows(group, kRestOn, name), 0, name);
  const auto points = hdf5::read_dataset<std::uint64_t>(
      group, kPoints, hdf5::dataset_rows(group, kPoints, name), 0, name);
  ColumnHashes hashes;
  hashes.add(quanta);
  hashes.add(texts);
  hashes.add(points);
  ColumnIndex index = read_index(file, group, kOriginColumn, name, cells, hashes, origins.hash);
  for (std::uint64_t i = 0; i < rows; ++i) {
    origins.quanta.push_back({quanta[3 * i], quanta[3 * i + 1], quanta[3 * i + 2]});
  }
  check_origins(origins, name);
  read_bases(texts, points, metadata, name);
  return index;
}

}  // namespace clearway
