#include "io/store/store_index.hpp"

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <span>
#include <string>

#include "clearway/error.hpp"
#include "core/cloud/kd_order.hpp"
#include "io/hdf5/hdf5.hpp"
#include "io/hdf5/kept_warnings.hpp"
#include "io/system/input_error.hpp"

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

/// Reads /sources/points. It is not part of the index's hash, which older releases check without
/// it, so damage is found by comparing the sum with the number of input points.
std::vector<std::uint64_t> read_source_points(const hdf5::Id& file, const std::string& name,
                                              const StoreMetadata& metadata) {
  const hdf5::Id group = hdf5::open_group(file, "sources", name);
  const htri_t found = H5Lexists(group.get(), kSourcePoints, H5P_DEFAULT);
  if (found <= 0) return {};
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

StoreMetadata read_metadata(const hdf5::Id& file, const std::string& name, ColumnHashes& hashes) {
  if (!hdf5::has_attribute(file, "format", name) ||
      hdf5::read_text_attribute(file, "format", name) != kStoreFormat) {
    refuse(name, "not a store, expected a file that 'clearway convert' wrote");
  }
  const auto version = hdf5::read_number<std::uint32_t>(file, "version", name);
  if (version != kStoreVersion) {
    refuse(name, "store format version " + std::to_string(version) + ", expected " +
                     std::to_string(kStoreVersion));
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
  metadata.layout = hdf5::read_text_attribute(file, "layout", name);
  metadata.unit = length_unit_of(hdf5::read_text_attribute(file, "length_unit", name));
  metadata.crs_wkt = hdf5::read_text_attribute(file, "crs_wkt", name);
  for (int k = 0; k < 3; ++k) {
    if (!(scale[k] > 0) || !std::isfinite(scale[k]) || !std::isfinite(offset[k])) {
      refuse(name, "attributes 'scale' and 'offset': expected finite numbers, the scale above 0");
    }
  }
  if (metadata.input_points < metadata.point_count) {
    refuse(name, "attribute 'input_points' is " + std::to_string(metadata.input_points) +
                     ", expected at least the points stored, " +
                     std::to_string(metadata.point_count));
  }
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
/// knows the first and the last chunk of a dataset at other addresses than the index.
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
  if (has_class_index(file)) {
    index.classes = read_class_index(file, name, index.cells.count.size(), index.metadata);
  }
  if (hashes.digest() != hdf5::read_number<std::uint64_t>(file, "index_hash", name)) {
    refuse(name, "its index of cells is damaged (its hash is not the one recorded)");
  }
  check_cells(index, file_bytes, name);
  index.classes.check(file_bytes, name);
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

}  // namespace clearway
