#include "io/store.hpp"

#include <hdf5.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/error.hpp"
#include "core/kd_order.hpp"
#include "io/hdf5.hpp"
#include "io/xxh64.hpp"

namespace clearway {
namespace {

/// As many as `convert` gives a cell at the most.
constexpr std::uint32_t kMostCellPoints = 1U << 20;

[[noreturn]] void refuse(const std::string& file, const std::string& what) {
  throw InputError(file + ": " + what);
}

template <typename Number>
Number number_attribute(const hdf5::Id& file, const char* name, const std::string& file_name) {
  return hdf5::read_attribute<Number>(file, name, 1, file_name)[0];
}

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

StoreMetadata read_metadata(const hdf5::Id& file, const std::string& name, ColumnHashes& hashes) {
  if (!hdf5::has_attribute(file, "format", name) ||
      hdf5::read_text_attribute(file, "format", name) != kStoreFormat) {
    refuse(name, "not a store, expected a file that 'clearway convert' wrote");
  }
  const auto version = number_attribute<std::uint32_t>(file, "version", name);
  if (version != kStoreVersion) {
    refuse(name, "store format version " + std::to_string(version) + ", expected " +
                     std::to_string(kStoreVersion));
  }
  if (!hdf5::has_attribute(file, "complete", name) ||
      number_attribute<std::uint32_t>(file, "complete", name) != 1) {
    refuse(name, "an unfinished store, expected a complete one; convert again");
  }
  StoreMetadata metadata;
  metadata.point_count = number_attribute<std::uint64_t>(file, "point_count", name);
  metadata.input_points = number_attribute<std::uint64_t>(file, "input_points", name);
  metadata.cell_points = number_attribute<std::uint32_t>(file, "cell_points", name);
  metadata.points_hash = number_attribute<std::uint64_t>(file, "points_hash", name);
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
  metadata.sources = read_sources(file, name, hashes);
  if (metadata.cell_points == 0 || metadata.cell_points > kMostCellPoints) {
    refuse(name, "attribute 'cell_points': expected 1 to " + std::to_string(kMostCellPoints));
  }
  return metadata;
}

CellIndex read_index(const hdf5::Id& file, const std::string& name) {
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

/// Another tool that copies a store moves its chunks: HDF5 then knows the first and the last of a
/// dataset at other addresses than the index.
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
      refuse(name,
             "its chunks are not where 'clearway convert' put them: another tool (h5repack, a "
             "copy by h5py) rewrote the file; convert the scans again, or copy the file as it is");
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

std::vector<Cell> cells_of(const CellIndex& index) {
  std::vector<Cell> cells(index.count.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::int32_t* box = index.box.data() + 6 * i;
    cells[i] = {index.count[i], {{box[0], box[1], box[2]}, {box[3], box[4], box[5]}}};
  }
  return cells;
}

}  // namespace

Store::Store(const std::filesystem::path& path) : map_(path) {
  const hdf5::Id file = hdf5::open_file(path);
  try {
    ColumnHashes hashes;
    metadata_ = read_metadata(file, name(), hashes);
    index_ = read_index(file, name());
    add_index(index_, hashes);
    check_not_rewritten(file, index_, name());
    cells_ = cells_of(index_);
    blocks_ = read_blocks(file, std::uint64_t{cells_.size()} * blocks_per_cell(), name(), hashes);
    top_ = read_tree(file, name(), hashes);
    if (hashes.digest() != number_attribute<std::uint64_t>(file, "index_hash", name())) {
      refuse(name(), "its index of cells is damaged (its hash is not the one recorded)");
    }
    check_index();
    tree_ = build_cell_tree(top_, cells_);
  } catch (const hdf5::Failure& error) {
    throw InputError(name() + ": damaged store: " + error.what());
  }
  checked_.resize(cells_.size());
  read_.resize(cells_.size());
}

void Store::check_index() const {
  std::uint64_t points = 0;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const Cell& cell = cells_[i];
    const std::string where = "cell " + std::to_string(i);
    if (cell.count == 0 || cell.count > cell_points()) {
      refuse(name(), where + " has " + std::to_string(cell.count) + " points, expected 1 to " +
                         std::to_string(cell_points()));
    }
    for (int k = 0; k < 3; ++k) {
      if (cell.box.lo[k] > cell.box.hi[k]) refuse(name(), where + " has an inverted box");
    }
    for (std::size_t c = 4 * i; c < 4 * i + 4; ++c) {
      const std::uint64_t size = map_.bytes().size();
      if (index_.address[c] > size || index_.bytes[c] > size - index_.address[c]) {
        refuse(name(),
               where + " has a chunk past the end of the file at byte " + std::to_string(size));
      }
    }
    points += cell.count;
  }
  if (points != metadata_.point_count) {
    refuse(name(), "its cells hold " + std::to_string(points) + " points, expected " +
                       std::to_string(metadata_.point_count));
  }
}

std::span<const std::byte> Store::checked_chunk(std::uint32_t cell, int dataset) const {
  const std::size_t i = 4 * std::size_t{cell} + static_cast<std::size_t>(dataset);
  const auto bytes = map_.bytes().subspan(index_.address[i], index_.bytes[i]);
  if (dataset < 3 && std::atomic_ref(checked_[cell]).load(std::memory_order_acquire) != 0) {
    return bytes;
  }
  check_hash(cell, dataset, bytes);
  return bytes;
}

void Store::check_hash(std::uint32_t cell, int dataset, std::span<const std::byte> bytes) const {
  const std::size_t i = 4 * std::size_t{cell} + static_cast<std::size_t>(dataset);
  if (xxh64(bytes) == index_.xxh64[i]) return;
  refuse(name(), "cell " + std::to_string(cell) + ": the packed bytes of '" +
                     kPointDatasets[dataset] + "' at byte " + std::to_string(index_.address[i]) +
                     " are damaged (their hash is not the one recorded)");
}

/// bytes: whose hash is right, or was once (a file that is written to while in use).
template <typename Number>
PackedChunk<Number> Store::chunk(std::uint32_t cell, int dataset,
                                 std::span<const std::byte> bytes) const {
  try {
    return {bytes, cell_points()};
  } catch (const InputError& error) {
    refuse(name(),
           "cell " + std::to_string(cell) + ": '" + kPointDatasets[dataset] + "': " + error.what());
  }
}

std::array<PackedChunk<std::int32_t>, 3> Store::coordinates(std::uint32_t cell) const {
  std::array<PackedChunk<std::int32_t>, 3> chunks;
  for (int axis = 0; axis < 3; ++axis) {
    chunks[static_cast<std::size_t>(axis)] =
        chunk<std::int32_t>(cell, axis, checked_chunk(cell, axis));
  }
  std::atomic_ref(checked_[cell]).store(1, std::memory_order_release);
  return chunks;
}

PackedChunk<std::uint64_t> Store::sources(std::uint32_t cell) const {
  return chunk<std::uint64_t>(cell, 3, checked_chunk(cell, 3));
}

std::uint64_t Store::packed_bytes(std::uint32_t cell) const {
  const std::uint32_t* bytes = index_.bytes.data() + 4 * std::size_t{cell};
  return std::uint64_t{bytes[0]} + bytes[1] + bytes[2];
}

std::array<PackedChunk<std::int32_t>, 3> Store::read_packed(std::uint32_t cell,
                                                            std::span<std::byte> to) const {
  const std::uint64_t* address = index_.address.data() + 4 * std::size_t{cell};
  const std::uint32_t* bytes = index_.bytes.data() + 4 * std::size_t{cell};
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
  for (int axis = 0; axis < 3; ++axis) {
    const auto part = parts[static_cast<std::size_t>(axis)];
    check_hash(cell, axis, part);
    chunks[static_cast<std::size_t>(axis)] = chunk<std::int32_t>(cell, axis, part);
  }
  std::atomic_ref(read_[cell]).store(1, std::memory_order_relaxed);
  return chunks;
}

std::uint64_t Store::fingerprint() const {
  Xxh64Stream hash;
  const auto add = [&hash](const auto& values) { hash.update(std::as_bytes(std::span(values))); };
  add(index_.xxh64);
  add(index_.count);
  add(index_.box);
  const std::array<std::uint64_t, 4> numbers{metadata_.point_count, metadata_.input_points,
                                             metadata_.cell_points, metadata_.points_hash};
  add(numbers);
  add(metadata_.quantisation.scale);
  add(metadata_.quantisation.offset);
  add(metadata_.crs_wkt);
  return hash.digest();
}

Store::Touched Store::touched() const {
  Touched touched;
  for (std::size_t cell = 0; cell < checked_.size(); ++cell) {
    if (checked_[cell] == 0 && read_[cell] == 0) continue;
    ++touched.cells;
    touched.bytes += packed_bytes(static_cast<std::uint32_t>(cell));
  }
  return touched;
}

std::uint64_t Store::allocated_bytes() const {
  const auto bytes = [](const auto& values) { return values.capacity() * sizeof(values[0]); };
  return bytes(index_.count) + bytes(index_.box) + bytes(index_.address) + bytes(index_.bytes) +
         bytes(index_.xxh64) + bytes(top_) + bytes(cells_) + bytes(tree_) + bytes(blocks_) +
         bytes(checked_) + bytes(read_);
}

}  // namespace clearway
