#include "io/store/store_reader.hpp"

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <functional>
#include <span>
#include <string>

#include "clearway/error.hpp"
#include "clearway/store.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/page/page.hpp"
#include "io/files/hdf5.hpp"
#include "io/files/input_error.hpp"
#include "io/files/kept_warnings.hpp"
#include "io/files/xxh64.hpp"

namespace clearway {
namespace {

std::vector<SourceFile> read_sources(const hdf5::Id& file, const std::string& file_name,
                                     ColumnHashes& hashes_of_all) {
  const hdf5::Id group = hdf5::open_group(file, "sources", file_name);
  const std::uint64_t count = hdf5::dataset_rows(group, "bytes", file_name);
  const auto bytes = hdf5::read_dataset<std::uint64_t>(group, "bytes", count, 0, file_name);
  const auto hashes = hdf5::read_dataset<std::uint64_t>(group, "xxh64", count, 0, file_name);
  const auto names = hdf5::read_dataset<std::uint8_t>(
      group, "names", hdf5::dataset_rows(group, "names", file_name), 0, file_name);
  if (static_cast<std::uint64_t>(std::count(names.begin(), names.end(), 0)) != count) {
    refuse(file_name, "dataset 'sources/names': expected " + std::to_string(count) + " names");
  }
  hashes_of_all.add(names);
  hashes_of_all.add(bytes);
  hashes_of_all.add(hashes);
  std::vector<SourceFile> sources(count);
  auto at = names.begin();
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto end = std::find(at, names.end(), 0);
    sources[i] = {std::string(at, end), bytes[i], hashes[i]};
    at = end + 1;
  }
  return sources;
}

/// Reads /sources/points. It is not part of the index's hash, so damage is found by comparing the
/// sum with the number of input points.
std::vector<std::uint64_t> read_source_points(const hdf5::Id& file, const std::string& name,
                                              const StoreMetadata& metadata) {
  const hdf5::Id group = hdf5::open_group(file, "sources", name);
  if (H5Lexists(group.get(), kSourcePoints, H5P_DEFAULT) <= 0) return {};
  auto points =
      hdf5::read_dataset<std::uint64_t>(group, kSourcePoints, metadata.sources.size(), 0, name);
  std::uint64_t sum = 0;
  bool fits = true;
  for (const std::uint64_t count : points) {
    fits &= count <= metadata.input_points - sum;
    sum += fits ? count : 0;
  }
  if (!fits || sum != metadata.input_points) {
    refuse(name, "dataset 'sources/points': expected counts that add up to input_points, " +
                     std::to_string(metadata.input_points));
  }
  return points;
}

/// Reads what the store says of withheld points; nullopt where the inputs have none.
std::optional<StoreWithheld> read_withheld(const hdf5::Id& file, const std::string& name) {
  if (!hdf5::has_attribute(file, kWithheldPoints, name)) return std::nullopt;
  StoreWithheld withheld{.points = hdf5::read_number<std::uint64_t>(file, kWithheldPoints, name)};
  withheld.kept = H5Lexists(file.get(), kWithheld, H5P_DEFAULT) <= 0;
  if (withheld.kept) return withheld;
  const std::uint64_t rows = hdf5::dataset_rows(file, kWithheld, name);
  const auto numbers = hdf5::read_dataset<std::int32_t>(file, kWithheld, rows, 3, name);
  ColumnHashes hashes;
  hashes.add(std::array{withheld.points});
  hashes.add(numbers);
  if (hashes.digest() != hdf5::read_number<std::uint64_t>(file, kWithheldHash, name)) {
    refuse(name, "dataset 'withheld' is damaged (its hash is not the one recorded)");
  }
  for (std::uint64_t i = 0; i < rows; ++i) {
    withheld.cubes.push_back({numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]});
  }
  const bool ascends = std::ranges::adjacent_find(withheld.cubes, std::ranges::greater_equal()) ==
                       withheld.cubes.end();
  if (rows == 0 || rows > withheld.points || !ascends) {
    refuse(name,
           "dataset 'withheld': expected ascending cubes, one at least and no more than points");
  }
  return withheld;
}

/// Reads the corridor that the store was made of; nullopt where it holds all points.
std::optional<StoreCorridor> read_corridor(const hdf5::Id& file, const std::string& name) {
  if (!hdf5::has_attribute(file, kNearWithin, name)) return std::nullopt;
  StoreCorridor near{.path = {}, .within = hdf5::read_number<double>(file, kNearWithin, name)};
  const auto whole = hdf5::read_attribute<double>(file, kNearWhole, 6, name);
  near.whole = {{whole[0], whole[1], whole[2]}, {whole[3], whole[4], whole[5]}};
  const auto counts = hdf5::read_attribute<std::uint64_t>(file, kNearCounts, 4, name);
  near.left_out = counts[0];
  near.unread = counts[1];
  near.unread_bytes = counts[2];
  near.passed_over = counts[3];
  const hdf5::Id group = hdf5::open_group(file, kNearGroup, name);
  const std::uint64_t rows = hdf5::dataset_rows(group, kNearPath, name);
  const auto numbers = hdf5::read_dataset<double>(group, kNearPath, rows, 3, name);
  for (std::uint64_t i = 0; i < rows; ++i) {
    near.path.push_back({numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]});
  }
  const auto is_finite = [](double value) { return std::isfinite(value); };
  if (hash_of(near) != hdf5::read_number<std::uint64_t>(file, kNearHash, name) || rows == 0 ||
      !std::ranges::all_of(numbers, is_finite) || !(near.within >= 0) ||
      !std::isfinite(near.within)) {
    refuse(name, "what it says of its corridor is damaged (its hash is not the one recorded)");
  }
  return near;
}

StoreMetadata read_metadata(const hdf5::Id& file, const std::string& name, ColumnHashes& hashes) {
  if (!hdf5::has_attribute(file, "format", name) ||
      hdf5::read_text_attribute(file, "format", name) != kStoreFormat) {
    refuse(name, "not a store, expected a file that 'clearway convert' wrote");
  }
  const auto version = hdf5::read_number<std::uint32_t>(file, "version", name);
  if (version != kStoreVersion) {
    refuse(name, "is a store of version " + std::to_string(version) +
                     " of another release; convert again");
  }
  if (!hdf5::has_attribute(file, "complete", name) ||
      hdf5::read_number<std::uint32_t>(file, "complete", name) != 1) {
    refuse(name, "an unfinished store, expected a complete one; convert again");
  }
  StoreMetadata metadata;
  metadata.point_count = hdf5::read_number<std::uint64_t>(file, "point_count", name);
  metadata.input_points = hdf5::read_number<std::uint64_t>(file, "input_points", name);
  metadata.cell_points = hdf5::read_number<std::uint32_t>(file, "cell_points", name);
  metadata.points_hash = hdf5::read_number<std::uint64_t>(file, "points_hash", name);
  const auto scale = hdf5::read_attribute<double>(file, "scale", 3, name);
  const auto offset = hdf5::read_attribute<double>(file, "offset", 3, name);
  std::copy(scale.begin(), scale.end(), metadata.quantisation.scale);
  std::copy(offset.begin(), offset.end(), metadata.quantisation.offset);
  const auto steps = hdf5::read_attribute<double>(file, "steps", 3, name);
  std::copy(steps.begin(), steps.end(), metadata.steps.begin());
  metadata.layout = hdf5::read_text_attribute(file, "layout", name);
  metadata.options = hdf5::read_text_attribute(file, "options", name);
  metadata.unit = length_unit_of(hdf5::read_text_attribute(file, "length_unit", name));
  metadata.crs_wkt = hdf5::read_text_attribute(file, "crs_wkt", name);
  if (hdf5::has_attribute(file, kHeightUnit, name)) {
    metadata.height_unit = hdf5::read_number<double>(file, kHeightUnit, name);
  }
  for (int k = 0; k < 3; ++k) {
    if (!(scale[k] > 0) || !std::isfinite(scale[k]) || !std::isfinite(offset[k])) {
      refuse(name, "attributes 'scale' and 'offset': expected finite numbers, the scale above 0");
    }
    if (!(steps[k] >= 0) || !std::isfinite(steps[k])) {
      refuse(name, "attribute 'steps': expected finite numbers of at least 0");
    }
  }
  if (metadata.input_points < metadata.point_count) {
    refuse(name, "attribute 'input_points' is " + std::to_string(metadata.input_points) +
                     ", expected at least the points stored, " +
                     std::to_string(metadata.point_count));
  }
  metadata.withheld = read_withheld(file, name);
  const std::uint64_t not_stored = metadata.input_points - metadata.point_count;
  if (metadata.withheld && metadata.withheld->left_out() > not_stored) {
    refuse(name, "attribute 'withheld_points' is " + std::to_string(metadata.withheld->points) +
                     ", expected at most the points not stored, " + std::to_string(not_stored));
  }
  metadata.near = read_corridor(file, name);
  if (metadata.near && metadata.near->left_out > not_stored) {
    refuse(name, "attribute 'near_counts' counts " + std::to_string(metadata.near->left_out) +
                     " points left out, expected at most the points not stored, " +
                     std::to_string(not_stored));
  }
  metadata.dates = read_scan_dates(file, name);
  if (H5Lexists(file.get(), "warnings", H5P_DEFAULT) > 0) {
    metadata.warnings = read_warnings(file, name);
  }
  metadata.sources = read_sources(file, name, hashes);
  metadata.source_points = read_source_points(file, name, metadata);
  if (metadata.cell_points == 0 || metadata.cell_points > kMostCellPoints) {
    refuse(name, "attribute 'cell_points': expected 1 to " + std::to_string(kMostCellPoints));
  }
  return metadata;
}

CellIndex read_cells(const hdf5::Id& file, const std::string& name) {
  const hdf5::Id group = hdf5::open_group(file, "cells", name);
  const std::uint64_t cells = hdf5::dataset_rows(group, "count", name);
  CellIndex index;
  index.count = hdf5::read_dataset<std::uint32_t>(group, "count", cells, 0, name);
  index.box = hdf5::read_dataset<std::int32_t>(group, "box", cells, 6, name);
  index.address = hdf5::read_dataset<std::uint64_t>(group, "address", cells, 4, name);
  index.bytes = hdf5::read_dataset<std::uint32_t>(group, "bytes", cells, 4, name);
  index.xxh64 = hdf5::read_dataset<std::uint64_t>(group, "xxh64", cells, 4, name);
  return index;
}

/// Throws InputError where another tool rewrote the store. Copying moves the chunks, so HDF5 then
/// knows the first and the last chunk of a dataset at addresses other than the index gives.
void check_not_rewritten(const hdf5::Id& file, const CellIndex& index, const std::string& name) {
  if (index.count.empty()) return;
  const hdf5::Id group = hdf5::open_group(file, "points", name);
  const hdf5::Id dataset = hdf5::open_dataset(group, kPointDatasets[0], name);
  for (const std::uint64_t cell : {std::uint64_t{0}, std::uint64_t{index.count.size() - 1}}) {
    const std::array<hsize_t, 2> at{cell, 0};
    unsigned filter_mask = 0;
    haddr_t address = 0;
    hsize_t bytes = 0;
    if (H5Dget_chunk_info_by_coord(dataset.get(), at.data(), &filter_mask, &address, &bytes) < 0 ||
        filter_mask != 0 || address != index.address[4 * cell] || bytes != index.bytes[4 * cell]) {
      refuse(
          name,
          "its chunks are not where 'clearway convert' put them. Another tool (h5repack, a copy by "
          "h5py) rewrote the file; convert the scans again, or copy the file as it is");
    }
  }
}

std::vector<TopNode> read_tree(const hdf5::Id& file, const std::string& name,
                               ColumnHashes& hashes) {
  const hdf5::Id group = hdf5::open_group(file, "tree", name);
  const std::uint64_t rows = hdf5::dataset_rows(group, "nodes", name);
  const auto values = hdf5::read_dataset<std::uint32_t>(group, "nodes", rows, 3, name);
  hashes.add(values);
  std::vector<TopNode> nodes(rows);
  for (std::uint64_t i = 0; i < rows; ++i) {
    nodes[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  }
  return nodes;
}

std::vector<BlockBox> read_blocks(const hdf5::Id& file, std::uint64_t rows, const std::string& name,
                                  ColumnHashes& hashes) {
  constexpr std::uint64_t kPieceRows = 1 << 16;
  const hdf5::Id group = hdf5::open_group(file, "blocks", name);
  const auto dataset = hdf5::Rows<std::uint16_t>::open(group, "box", 6, name);
  if (dataset.rows() != rows) {
    refuse(name, "dataset 'blocks/box': expected " + std::to_string(rows) + " rows");
  }
  std::vector<BlockBox> blocks(rows);
  std::vector<std::uint16_t> piece;
  for (std::uint64_t row = 0; row < rows; row += kPieceRows) {
    piece.resize(6 * std::min(kPieceRows, rows - row));
    dataset.read(row, piece);
    std::memcpy(blocks.data() + row, piece.data(), piece.size() * sizeof(std::uint16_t));
  }
  hashes.add(blocks);
  return blocks;
}

/// Checks the index of cells against the length of the file and the metadata. Throws InputError.
void check_cells(const StoreIndex& index, std::uint64_t file_bytes, const std::string& name) {
  const CellIndex& cells = index.cells;
  const std::uint32_t cell_points = index.metadata.cell_points;
  std::uint64_t points = 0;
  for (std::size_t i = 0; i < cells.count.size(); ++i) {
    const std::string where = "cell " + std::to_string(i);
    if (cells.count[i] == 0 || cells.count[i] > cell_points) {
      refuse(name, where + " has " + std::to_string(cells.count[i]) + " points, expected 1 to " +
                       std::to_string(cell_points));
    }
    for (std::size_t k = 6 * i; k < 6 * i + 3; ++k) {
      if (cells.box[k] > cells.box[k + 3]) refuse(name, where + " has an inverted box");
    }
    for (std::size_t c = 4 * i; c < 4 * i + 4; ++c) {
      if (cells.address[c] > file_bytes || cells.bytes[c] > file_bytes - cells.address[c]) {
        refuse(name, where + " has a chunk past the end of the file at byte " +
                         std::to_string(file_bytes));
      }
    }
    points += cells.count[i];
  }
  if (points != index.metadata.point_count) {
    refuse(name, "its cells hold " + std::to_string(points) + " points, expected " +
                     std::to_string(index.metadata.point_count));
  }
}

StoreIndex read_index(const hdf5::Id& file, std::uint64_t file_bytes, const std::string& name) {
  StoreIndex index;
  ColumnHashes hashes;
  index.metadata = read_metadata(file, name, hashes);
  index.cells = read_cells(file, name);
  add_index(index.cells, hashes);
  check_not_rewritten(file, index.cells, name);
  const std::uint64_t blocks_per_cell = divide_up(index.metadata.cell_points, kBlockPoints);
  index.blocks = read_blocks(file, index.cells.count.size() * blocks_per_cell, name, hashes);
  index.top = read_tree(file, name, hashes);
  const std::uint64_t cells = index.cells.count.size();
  if (has_column(file, kClassColumn)) {
    index.classes = read_classes(file, name, cells, index.metadata);
  }
  if (has_column(file, kOriginColumn)) {
    index.origins = read_origins(file, name, cells, index.metadata);
  }
  if (hashes.digest() != hdf5::read_number<std::uint64_t>(file, "index_hash", name)) {
    refuse(name, "its index of cells is damaged (its hash is not the one recorded)");
  }
  check_cells(index, file_bytes, name);
  index.classes.check(kClassColumn, file_bytes, name);
  index.origins.check(kOriginColumn, file_bytes, name);
  return index;
}

}  // namespace

StoreIndex read_store_index(const std::filesystem::path& path, std::uint64_t file_bytes) {
  const std::string name = path.string();
  const hdf5::QuietScope quiet;
  const hdf5::Id file = hdf5::open_file(path);
  try {
    return read_index(file, file_bytes, name);
  } catch (const hdf5::Failure& error) {
    throw InputError(name + ": damaged store: " + error.what());
  }
}

namespace {

std::vector<Cell> cells_of(const CellIndex& index) {
  std::vector<Cell> cells(index.count.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::int32_t* box = index.box.data() + 6 * i;
    cells[i] = {index.count[i], {{box[0], box[1], box[2]}, {box[3], box[4], box[5]}}};
  }
  return cells;
}

}  // namespace

StoreReader::StoreReader(const std::filesystem::path& path)
    : map_(path),
      index_(read_store_index(path, map_.bytes().size())),
      cells_(cells_of(index_.cells)),
      tree_(build_cell_tree(index_.top, cells_)),
      checked_(cells_.size()),
      read_(cells_.size()),
      sources_checked_(cells_.size()),
      classes_checked_(index_.classes.address.size()),
      origins_checked_(index_.origins.address.size()) {}

std::span<const std::byte> StoreReader::checked_chunk(std::uint32_t cell, int dataset) const {
  const std::size_t i = 4 * std::size_t{cell} + static_cast<std::size_t>(dataset);
  const auto bytes = map_.bytes().subspan(index_.cells.address[i], index_.cells.bytes[i]);
  if (dataset < 3 && std::atomic_ref(checked_[cell]).load(std::memory_order_acquire) != 0) {
    return bytes;
  }
  check_hash(cell, dataset, bytes);
  return bytes;
}

void StoreReader::check_hash(std::uint32_t cell, int dataset,
                             std::span<const std::byte> bytes) const {
  const std::size_t i = 4 * std::size_t{cell} + static_cast<std::size_t>(dataset);
  if (xxh64(bytes) == index_.cells.xxh64[i]) return;
  refuse_damaged(cell, kPointDatasets[dataset], index_.cells.address[i]);
}

void StoreReader::refuse_damaged(std::uint32_t cell, const char* dataset,
                                 std::uint64_t byte) const {
  refuse(name(), "cell " + std::to_string(cell) + ": the packed bytes of '" + dataset +
                     "' at byte " + std::to_string(byte) +
                     " are damaged (their hash is not the one recorded)");
}

/// Decodes the header of a packed chunk. The hash of `bytes` was right when checked, but the file
/// may have been written to since. Throws InputError for a damaged chunk.
template <typename Number>
PackedChunk<Number> StoreReader::chunk(std::uint32_t cell, const char* dataset,
                                       std::span<const std::byte> bytes) const {
  try {
    return {bytes, cell_points()};
  } catch (const InputError& error) {
    refuse(name(), "cell " + std::to_string(cell) + ": '" + dataset + "': " + error.what());
  }
}

std::array<PackedChunk<std::int32_t>, 3> StoreReader::mapped_coordinates(std::uint32_t cell) const {
  std::array<PackedChunk<std::int32_t>, 3> chunks;
  for (int axis = 0; axis < 3; ++axis) {
    chunks[static_cast<std::size_t>(axis)] =
        chunk<std::int32_t>(cell, kPointDatasets[axis], checked_chunk(cell, axis));
  }
  return chunks;
}

std::array<PackedChunk<std::int32_t>, 3> StoreReader::coordinates(std::uint32_t cell) const {
  const auto chunks = mapped_coordinates(cell);
  std::atomic_ref(checked_[cell]).store(1, std::memory_order_release);
  handed_out_.coordinates.add(packed_bytes(cell));
  return chunks;
}

std::array<PackedChunk<std::int32_t>, 3> StoreReader::coordinates_of_block(
    std::uint32_t cell) const {
  const auto chunks = mapped_coordinates(cell);  // which checks them, unless that is done
  std::atomic_ref(checked_[cell]).store(1, std::memory_order_release);
  handed_out_.coordinates.add(packed_bytes(cell) / blocks_per_cell());
  return chunks;
}

std::array<PackedChunk<std::int32_t>, 3> StoreReader::peek(std::uint32_t cell) const {
  handed_out_.coordinates.add(packed_bytes(cell));
  return mapped_coordinates(cell);
}

Vec3 StoreReader::position_of(std::uint32_t cell, std::uint32_t index) const {
  const auto q = mapped_coordinates(cell);
  handed_out_.coordinates.add(3 * sizeof(std::int32_t));
  return position(quantisation(), q[0][index], q[1][index], q[2][index]);
}

PackedChunk<std::uint64_t> StoreReader::mapped_sources(std::uint32_t cell) const {
  const std::atomic_ref checked(sources_checked_[cell]);
  if (checked.load(std::memory_order_acquire) == 0) {
    checked_chunk(cell, 3);
    checked.store(1, std::memory_order_release);
  }
  const std::size_t i = 4 * std::size_t{cell} + 3;
  const auto bytes = map_.bytes().subspan(index_.cells.address[i], index_.cells.bytes[i]);
  return chunk<std::uint64_t>(cell, kPointDatasets[3], bytes);
}

PackedChunk<std::uint64_t> StoreReader::sources(std::uint32_t cell) const {
  handed_out_.sources.add(index_.cells.bytes[4 * std::size_t{cell} + 3]);
  return mapped_sources(cell);
}

std::uint64_t StoreReader::source_of(std::uint32_t cell, std::uint32_t index) const {
  handed_out_.sources.add(sizeof(std::uint64_t));
  return mapped_sources(cell)[index];
}

/// The packed values of a cell in a column, checked against their hash at the first call for it.
/// checked: notes per cell that this was done.
template <typename Number>
PackedChunk<Number> StoreReader::column_chunk(const PointColumn& column, const ColumnIndex& index,
                                              std::vector<std::uint8_t>& checked,
                                              std::uint32_t cell) const {
  const auto bytes = map_.bytes().subspan(index.address[cell], index.bytes[cell]);
  const std::atomic_ref done(checked[cell]);
  if (done.load(std::memory_order_acquire) == 0) {
    if (xxh64(bytes) != index.xxh64[cell]) {
      refuse_damaged(cell, column.dataset, index.address[cell]);
    }
    done.store(1, std::memory_order_release);
  }
  return chunk<Number>(cell, column.dataset, bytes);
}

PackedChunk<std::uint8_t> StoreReader::classes(std::uint32_t cell) const {
  handed_out_.classes.add(index_.classes.bytes[cell]);
  return column_chunk<std::uint8_t>(kClassColumn, index_.classes, classes_checked_, cell);
}

std::uint8_t StoreReader::class_of(std::uint32_t cell, std::uint32_t index) const {
  handed_out_.classes.add(1);
  return column_chunk<std::uint8_t>(kClassColumn, index_.classes, classes_checked_, cell)[index];
}

PackedChunk<std::uint32_t> StoreReader::origins(std::uint32_t cell) const {
  handed_out_.origins.add(index_.origins.bytes[cell]);
  return column_chunk<std::uint32_t>(kOriginColumn, index_.origins, origins_checked_, cell);
}

std::uint64_t StoreReader::packed_bytes(std::uint32_t cell) const {
  const std::uint32_t* bytes = index_.cells.bytes.data() + 4 * std::size_t{cell};
  return std::uint64_t{bytes[0]} + bytes[1] + bytes[2];
}

std::array<PackedChunk<std::int32_t>, 3> StoreReader::read_packed(std::uint32_t cell,
                                                                  std::span<std::byte> to) const {
  const std::uint64_t* address = index_.cells.address.data() + 4 * std::size_t{cell};
  const std::uint32_t* bytes = index_.cells.bytes.data() + 4 * std::size_t{cell};
  const File& file = map_.file();
  const std::array<std::span<std::byte>, 3> parts{to.subspan(0, bytes[0]),
                                                  to.subspan(bytes[0], bytes[1]),
                                                  to.subspan(bytes[0] + bytes[1], bytes[2])};
  if (address[1] == address[0] + bytes[0] && address[2] == address[1] + bytes[1]) {
    file.read_at(address[0], to);
  } else {
    for (std::size_t axis = 0; axis < 3; ++axis) file.read_at(address[axis], parts[axis]);
  }
  std::array<PackedChunk<std::int32_t>, 3> chunks;
  const std::atomic_ref was_read(read_[cell]);
  const bool was_right = was_read.load(std::memory_order_relaxed) != 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto part = parts[static_cast<std::size_t>(axis)];
    if (!was_right) check_hash(cell, axis, part);
    chunks[static_cast<std::size_t>(axis)] = chunk<std::int32_t>(cell, kPointDatasets[axis], part);
  }
  was_read.store(1, std::memory_order_relaxed);
  handed_out_.coordinates.add(packed_bytes(cell));
  return chunks;
}

std::optional<std::array<PackedChunk<std::int32_t>, 3>> StoreReader::in_place(
    std::uint32_t cell) const {
  for (std::size_t i = 4 * std::size_t{cell}; i < 4 * std::size_t{cell} + 3; ++i) {
    const std::uint64_t end = index_.cells.address[i] + index_.cells.bytes[i];
    if (end + kPagePadding > map_.bytes().size()) return std::nullopt;
  }
  return coordinates(cell);
}

std::uint64_t StoreReader::fingerprint() const {
  Xxh64Stream hash;
  const auto add = [&hash](const auto& values) { hash.update(std::as_bytes(std::span(values))); };
  add(index_.cells.xxh64);
  add(index_.cells.count);
  add(index_.cells.box);
  const std::array<std::uint64_t, 4> numbers{metadata().point_count, metadata().input_points,
                                             metadata().cell_points, metadata().points_hash};
  add(numbers);
  add(metadata().quantisation.scale);
  add(metadata().quantisation.offset);
  add(metadata().steps);
  add(metadata().crs_wkt);
  add(std::string(to_string(metadata().unit)));
  add(metadata().options);
  for (const Message& warning : metadata().warnings) {
    add(warning.code);
    add(warning.text);
  }
  if (metadata().withheld) {
    add(std::array{metadata().withheld->points});
    add(metadata().withheld->cubes);
  }
  if (metadata().near) add(std::array{hash_of(*metadata().near)});
  if (has_classes()) add(index_.classes.xxh64);
  if (has_origins()) {
    add(index_.origins.xxh64);
    add(metadata().origins->quanta);
  }
  return hash.digest();
}

void StoreReader::check_unchanged() const {
  if (map_.file().is_reached_by(name()) && map_.file().stamp() == stamp_) return;
  refuse(name(),
         "the file was replaced or changed since it was opened, so its points are no longer known; "
         "open it again");
}

void StoreReader::check_read() const {
  if (!map_.failed()) return;
  refuse(name(), "the file shrank or could not be read while it was in use");
}

std::uint64_t StoreReader::cells_touched() const {
  std::uint64_t cells = 0;
  const auto is_set = [](std::uint8_t& flag) {
    return std::atomic_ref(flag).load(std::memory_order_relaxed) != 0;
  };
  for (std::size_t cell = 0; cell < checked_.size(); ++cell) {
    cells += is_set(checked_[cell]) || is_set(read_[cell]);
  }
  return cells;
}

BytesRead StoreReader::bytes_read() const {
  return {handed_out_.coordinates.bytes, handed_out_.sources.bytes, handed_out_.classes.bytes,
          handed_out_.origins.bytes};
}

Box StoreReader::bounds() const {
  return metadata().near ? metadata().near->whole : PackedCloud::bounds();
}

double StoreReader::typical_block() const {
  std::call_once(typical_block_found_, [this] { typical_block_ = PackedCloud::typical_block(); });
  return typical_block_;
}

std::uint64_t StoreReader::allocated_bytes() const {
  const auto bytes = [](const auto& values) { return values.capacity() * sizeof(values[0]); };
  return bytes(index_.cells.count) + bytes(index_.cells.box) + bytes(index_.cells.address) +
         bytes(index_.cells.bytes) + bytes(index_.cells.xxh64) + bytes(index_.top) + bytes(cells_) +
         bytes(tree_) + bytes(index_.blocks) + bytes(checked_) + bytes(read_) +
         bytes(sources_checked_) + index_.classes.allocated_bytes() + bytes(classes_checked_) +
         index_.origins.allocated_bytes() + bytes(origins_checked_) +
         (has_origins() ? bytes(metadata().origins->quanta) : 0) +
         (metadata().withheld ? bytes(metadata().withheld->cubes) : 0) +
         (metadata().near ? bytes(metadata().near->path) : 0);
}

Store::Store(const std::filesystem::path& path)
    : path_(path), reader_(std::make_unique<StoreReader>(path)) {}
Store::~Store() = default;
Store::Store(Store&&) noexcept = default;
Store& Store::operator=(Store&&) noexcept = default;

std::uint64_t Store::point_count() const { return reader_->point_count(); }
std::uint64_t Store::cell_count() const { return reader_->cells().size(); }

Box Store::box() const {
  if (reader_->tree().empty()) return {};
  return position_box(reader_->quantisation(), reader_->tree()[0].box);
}

std::vector<std::uint64_t> Store::class_points() const {
  const auto& classes = reader_->metadata().classes;
  if (!classes) return {};
  return {classes->points.begin(), classes->points.end()};
}

bool Store::has_origins() const { return reader_->has_origins(); }
const std::string& Store::crs_wkt() const { return reader_->metadata().crs_wkt; }
std::string Store::length_unit() const { return to_string(reader_->metadata().unit); }

std::vector<Message> Store::warnings() const { return store_warnings(reader_->metadata()); }

double Store::metres_per_unit() const {
  const double metres = metres_of(reader_->metadata().unit);
  return metres > 0 ? metres : 1;
}

}  // namespace clearway
