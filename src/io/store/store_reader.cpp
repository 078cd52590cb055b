#include "io/store/store_reader.hpp"

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <type_traits>

#include "clearway/error.hpp"
#include "clearway/store.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/page/page.hpp"
#include "io/files/hdf5.hpp"
#include "io/files/header_values.hpp"
#include "io/files/input_error.hpp"
#include "io/files/xxh64.hpp"

namespace clearway {
namespace {

void require(bool holds, const std::string& name, const std::string& otherwise) {
  if (!holds) refuse(name, otherwise);
}

/// Reads the columns that belong to the metadata.
void read_columns(const TableFile& file, StoreMetadata& metadata) {
  const auto is_finite = [](const Vec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  };
  const auto ascends = [](const auto& values) {
    return !values.empty() &&
           std::ranges::adjacent_find(values, std::ranges::greater_equal()) == values.end();
  };
  if (metadata.withheld && !metadata.withheld->kept) {
    auto& cubes = metadata.withheld->cubes = file.all<MetreCube>("withheld/cube");
    require(ascends(cubes) && cubes.size() <= metadata.withheld->points, file.name(),
            "dataset 'withheld/cube': expected ascending cubes, one at least and no more than "
            "points");
  }
  if (metadata.near) {
    auto& path = metadata.near->path = file.all<Vec3>("near/path");
    require(!path.empty() && std::ranges::all_of(path, is_finite), file.name(),
            "dataset 'near/path': expected finite places, one at least");
  }
  if (metadata.origins) {
    auto& quanta = metadata.origins->quanta =
        file.all<std::array<std::int64_t, 3>>("origins/quanta");
    constexpr std::int64_t kFarthest = std::int64_t{1} << 62;
    const auto is_near = [](const std::array<std::int64_t, 3>& q) {
      return std::ranges::all_of(q, [](auto k) { return k >= -kFarthest && k <= kFarthest; });
    };
    require(ascends(quanta) && quanta.size() < std::numeric_limits<std::uint32_t>::max() &&
                std::ranges::all_of(quanta, is_near),
            file.name(),
            "dataset 'origins/quanta': expected ascending origins, one at least, of values from "
            "-2^62 to 2^62");
  }
}

/// Reads a column of `per_cell` numbers of each cell.
template <typename Number, std::size_t kPerCell>
std::vector<Number> read_numbers(const TableFile& file, const std::string& path) {
  using Value = std::conditional_t<kPerCell == 1, Number, std::array<Number, kPerCell>>;
  const StoredValues<Value> column = file.column<Value>(path);
  std::vector<Number> numbers(kPerCell * column.rows());
  column.read_bytes(0, std::as_writable_bytes(std::span(numbers)));
  return numbers;
}

template <std::size_t kPerCell>
ChunkIndex read_chunks(const TableFile& file, const std::string& group) {
  return {read_numbers<std::uint64_t, kPerCell>(file, group + "/address"),
          read_numbers<std::uint32_t, kPerCell>(file, group + "/bytes"),
          read_numbers<std::uint64_t, kPerCell>(file, group + "/xxh64")};
}

/// Throws InputError where another tool rewrote the store. Copying moves the chunks, so HDF5 then
/// knows the first and the last chunk of a dataset at addresses other than the index gives.
void check_not_rewritten(const hdf5::Id& file, const ChunkIndexes& chunks, std::size_t cells,
                         const std::string& name) {
  if (cells == 0) return;
  const hdf5::Id dataset = hdf5::open_dataset(file, "points/x", name);
  for (const std::size_t cell : {std::size_t{0}, cells - 1}) {
    const std::array<hsize_t, 2> at{cell, 0};
    unsigned filter_mask = 0;
    haddr_t address = 0;
    hsize_t bytes = 0;
    if (H5Dget_chunk_info_by_coord(dataset.get(), at.data(), &filter_mask, &address, &bytes) < 0 ||
        filter_mask != 0 || address != chunks.of(kX, cell).address ||
        bytes != chunks.of(kX, cell).bytes) {
      refuse(
          name,
          "its chunks are not where 'clearway convert' put them. Another tool (h5repack, a copy by "
          "h5py) rewrote the file; convert the scans again, or copy the file as it is");
    }
  }
}

/// Checks the cells and their chunks against the length of the file and the metadata. Throws
/// InputError.
void check_cells(const StoreIndex& index, std::uint64_t file_bytes, const std::string& name) {
  const std::uint32_t cell_points = index.metadata.cell_points;
  std::uint64_t points = 0;
  for (std::size_t i = 0; i < index.cells.size(); ++i) {
    const auto& [count, box] = index.cells[i];
    const auto where = [&] { return "cell " + std::to_string(i); };
    if (count == 0 || count > cell_points) {
      refuse(name, where() + " has " + std::to_string(count) + " points, expected 1 to " +
                       std::to_string(cell_points));
    }
    for (int k = 0; k < 3; ++k) {
      if (box.lo[k] > box.hi[k]) refuse(name, where() + " has an inverted box");
    }
    points += count;
  }
  for (const std::uint32_t bytes : index.chunks[1].bytes) {
    if (bytes == block_chunk_bytes(cell_points)) continue;
    refuse(name, "a cell has " + std::to_string(bytes) + " bytes of block boxes, expected " +
                     std::to_string(block_chunk_bytes(cell_points)));
  }
  for (const ChunkIndex& of : index.chunks) {
    for (std::size_t i = 0; i < of.address.size(); ++i) {
      if (of.address[i] <= file_bytes && of.bytes[i] <= file_bytes - of.address[i]) continue;
      refuse(name, "a chunk at byte " + std::to_string(of.address[i]) +
                       " reaches past the end of the file at byte " + std::to_string(file_bytes));
    }
  }
  if (points != index.metadata.point_count) {
    refuse(name, "its cells hold " + std::to_string(points) + " points, expected " +
                     std::to_string(index.metadata.point_count));
  }
}

/// Reads the index of a store, whose file has `file_bytes` bytes, and checks it. Throws InputError
/// where the file is not a complete store of this version with an intact index, or where another
/// tool rewrote it.
StoreIndex read_index(const std::filesystem::path& path, std::uint64_t file_bytes) {
  const hdf5::QuietScope quiet;
  const TableFile file(path, kStoreKind);
  const std::string& name = file.name();
  StoreIndex index;
  StoreMetadata& metadata = index.metadata;
  HeaderValues values(file.header(), name);
  keep_facts(values, metadata);
  read_columns(file, metadata);
  const auto count = file.all<std::uint32_t>("cells/count");
  const auto box = file.all<QuantumBox>("cells/box");
  index.chunks[0] = read_chunks<4>(file, "cells");
  index.chunks[1] = read_chunks<1>(file, "blocks");
  if (metadata.classes) index.chunks[2] = read_chunks<1>(file, "classes");
  if (metadata.origins) index.chunks[3] = read_chunks<1>(file, "origins");
  index.top = file.all<TopNode>("tree/nodes");
  const std::size_t cells = count.size();
  bool fits = box.size() == cells;
  const std::array has{true, true, metadata.classes.has_value(), metadata.origins.has_value()};
  for (std::size_t group = 0; group < has.size(); ++group) {
    const auto& [address, bytes, xxh64] = index.chunks[group];
    const std::size_t chunks = has[group] ? cells * kChunkGroups[group].columns : 0;
    fits &= address.size() == chunks && bytes.size() == chunks && xxh64.size() == chunks;
  }
  require(fits, name, "its index has columns of other cells than it counts");
  index.cells.resize(cells);
  for (std::size_t i = 0; i < cells; ++i) index.cells[i] = {count[i], box[i]};
  check_not_rewritten(file.file(), index.chunks, cells, name);
  check_cells(index, file_bytes, name);
  return index;
}

}  // namespace

StoreReader::StoreReader(const std::filesystem::path& path)
    : map_(path),
      index_(read_index(path, map_.bytes().size())),
      tree_(build_cell_tree(index_.top, index_.cells)),
      read_(index_.cells.size()) {
  checked_[0].resize(index_.cells.size());
  checked_[1].resize(index_.cells.size());
  for (std::size_t group = 1; group < kChunkGroups.size(); ++group) {
    checked_[group + 1].resize(index_.chunks[group].address.size());
  }
}

void StoreReader::check_hash(std::size_t column, std::uint32_t cell,
                             std::span<const std::byte> bytes) const {
  const StoredChunk chunk = index_.chunks.of(column, cell);
  if (xxh64(bytes) == chunk.xxh64) return;
  refuse(name(), "cell " + std::to_string(cell) + ": the packed bytes of '" +
                     kPointColumnNames[column] + "' at byte " + std::to_string(chunk.address) +
                     " are damaged (their hash is not the one recorded)");
}

/// Decodes the header of a packed chunk. The hash of `bytes` was right when checked, but the file
/// may have been written to since. Throws InputError for a damaged chunk.
template <typename Number>
PackedChunk<Number> StoreReader::chunk(std::size_t column, std::uint32_t cell,
                                       std::span<const std::byte> bytes) const {
  try {
    return {bytes, cell_points()};
  } catch (const InputError& error) {
    refuse(name(), "cell " + std::to_string(cell) + ": '" + kPointColumnNames[column] +
                       "': " + error.what());
  }
}

/// The bytes of a chunk in the map, checked against their hash unless that was done. Notes that it
/// was, but for a coordinate, since coordinates are touched by threes.
std::span<const std::byte> StoreReader::checked_bytes(std::size_t column,
                                                      std::uint32_t cell) const {
  const StoredChunk stored = index_.chunks.of(column, cell);
  const auto bytes = map_.bytes().subspan(stored.address, stored.bytes);
  const std::atomic_ref done(checked_[column < kSource ? 0 : column - kZ][cell]);
  if (done.load(std::memory_order_acquire) == 0) {
    check_hash(column, cell, bytes);
    if (column >= kSource) done.store(1, std::memory_order_release);
  }
  return bytes;
}

template <typename Number>
PackedChunk<Number> StoreReader::mapped(std::size_t column, std::uint32_t cell) const {
  return chunk<Number>(column, cell, checked_bytes(column, cell));
}

BlockBoxes StoreReader::blocks(std::uint32_t cell) const {
  return BlockBoxes(
      checked_bytes(kBlocks, cell).first(std::size_t{blocks_per_cell()} * sizeof(BlockBox)));
}

std::array<PackedChunk<std::int32_t>, 3> StoreReader::mapped_coordinates(std::uint32_t cell) const {
  return {mapped<std::int32_t>(kX, cell), mapped<std::int32_t>(kY, cell),
          mapped<std::int32_t>(kZ, cell)};
}

std::array<PackedChunk<std::int32_t>, 3> StoreReader::coordinates(std::uint32_t cell) const {
  const auto chunks = mapped_coordinates(cell);
  std::atomic_ref(checked_[0][cell]).store(1, std::memory_order_release);
  handed_out_.coordinates.add(packed_bytes(cell));
  return chunks;
}

std::array<PackedChunk<std::int32_t>, 3> StoreReader::coordinates_of_block(
    std::uint32_t cell) const {
  const auto chunks = mapped_coordinates(cell);  // which checks them, unless that is done
  std::atomic_ref(checked_[0][cell]).store(1, std::memory_order_release);
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

PackedChunk<std::uint64_t> StoreReader::sources(std::uint32_t cell) const {
  handed_out_.sources.add(index_.chunks.of(kSource, cell).bytes);
  return mapped<std::uint64_t>(kSource, cell);
}

std::uint64_t StoreReader::source_of(std::uint32_t cell, std::uint32_t index) const {
  handed_out_.sources.add(sizeof(std::uint64_t));
  return mapped<std::uint64_t>(kSource, cell)[index];
}

PackedChunk<std::uint8_t> StoreReader::classes(std::uint32_t cell) const {
  handed_out_.classes.add(index_.chunks.of(kClass, cell).bytes);
  return mapped<std::uint8_t>(kClass, cell);
}

std::uint8_t StoreReader::class_of(std::uint32_t cell, std::uint32_t index) const {
  handed_out_.classes.add(1);
  return mapped<std::uint8_t>(kClass, cell)[index];
}

PackedChunk<std::uint32_t> StoreReader::origins(std::uint32_t cell) const {
  handed_out_.origins.add(index_.chunks.of(kOrigin, cell).bytes);
  return mapped<std::uint32_t>(kOrigin, cell);
}

std::uint64_t StoreReader::packed_bytes(std::uint32_t cell) const {
  const std::uint32_t* bytes = index_.chunks[0].bytes.data() + 4 * std::size_t{cell};
  return std::uint64_t{bytes[0]} + bytes[1] + bytes[2];
}

std::array<PackedChunk<std::int32_t>, 3> StoreReader::read_packed(std::uint32_t cell,
                                                                  std::span<std::byte> to) const {
  const std::uint64_t* address = index_.chunks[0].address.data() + 4 * std::size_t{cell};
  const std::uint32_t* bytes = index_.chunks[0].bytes.data() + 4 * std::size_t{cell};
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
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!was_right) check_hash(axis, cell, parts[axis]);
    chunks[axis] = chunk<std::int32_t>(axis, cell, parts[axis]);
  }
  was_read.store(1, std::memory_order_relaxed);
  handed_out_.coordinates.add(packed_bytes(cell));
  return chunks;
}

std::optional<std::array<PackedChunk<std::int32_t>, 3>> StoreReader::in_place(
    std::uint32_t cell) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const StoredChunk stored = index_.chunks.of(axis, cell);
    if (stored.address + stored.bytes + kPagePadding > map_.bytes().size()) return std::nullopt;
  }
  return coordinates(cell);
}

std::uint64_t StoreReader::fingerprint() const {
  Xxh64Stream hash;
  const auto add = [&hash](const auto& values) { hash.update(std::as_bytes(std::span(values))); };
  add(index_.chunks[0].xxh64);
  for (const Cell& cell : cells()) add(std::span(&cell.count, 1));
  for (const Cell& cell : cells()) add(std::span(&cell.box, 1));
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
  if (metadata().near) {
    add(metadata().near->path);
    add(line_text(as_header(*metadata().near)));
  }
  if (has_classes()) add(index_.chunks[2].xxh64);
  if (has_origins()) {
    add(index_.chunks[3].xxh64);
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
  for (std::size_t cell = 0; cell < read_.size(); ++cell) {
    cells += is_set(checked_[0][cell]) || is_set(read_[cell]);
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
  std::uint64_t sum = bytes(index_.cells) + bytes(index_.top) + bytes(tree_) + bytes(read_);
  for (const ChunkIndex& index : index_.chunks) {
    sum += bytes(index.address) + bytes(index.bytes) + bytes(index.xxh64);
  }
  for (const std::vector<std::uint8_t>& checked : checked_) sum += bytes(checked);
  if (has_origins()) sum += bytes(metadata().origins->quanta);
  if (metadata().withheld) sum += bytes(metadata().withheld->cubes);
  if (metadata().near) sum += bytes(metadata().near->path);
  return sum;
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
