#include "io/store/store_writer.hpp"

#include <fcntl.h>
#include <hdf5.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <system_error>
#include <thread>
#include <utility>

#include "clearway/error.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "io/files/file.hpp"
#include "io/files/hdf5.hpp"
#include "io/files/kept_warnings.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/files/xxh64.hpp"
#include "io/store/point_columns.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {
namespace {

/// Speeds up the writing of a large file that someone else writes front to back. Space is reserved
/// ahead of the writer, which makes each write cheaper, and written bytes are sent to the disk
/// early, so that the last sync is short. Failures here are ignored; the writer and the sync
/// meet them.
class GrowingFile {
 public:
  explicit GrowingFile(const std::filesystem::path& path);
  ~GrowingFile();
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  /// Reports that all bytes before `end` are written.
  void written(std::uint64_t end);
  /// Frees what was reserved after the end of the file, which is complete now.
  void trim();

 private:
  void reserve_ahead(std::uint64_t end);
  void write_back(const std::stop_token& stop);

  std::filesystem::path folder_;
  File file_;
  std::uint64_t reserved_ = 0;
  bool may_reserve_ = true, may_write_back_ = true;
  std::mutex mutex_;
  std::condition_variable_any grown_;
  std::uint64_t written_ = 0;  // guarded by mutex_
  std::jthread writing_back_;  // starts with the first large piece; must be the last member
};

// Bytes that are reserved or written back at once.
constexpr std::uint64_t kPiece = std::uint64_t{64} << 20;
constexpr std::uint64_t kLeastFree = 16;  // pieces that must be free on the disk for reserving

GrowingFile::GrowingFile(const std::filesystem::path& path)
    : folder_(folder_of(path)), file_(File::open_for_writing(path)) {}

GrowingFile::~GrowingFile() = default;

void GrowingFile::written(std::uint64_t end) {
  if (end < kPiece) return;
  reserve_ahead(end);
  {
    const std::lock_guard lock(mutex_);
    written_ = end;
  }
  if (may_write_back_ && !writing_back_.joinable()) {
    try {
      writing_back_ = std::jthread([this](const std::stop_token& stop) { write_back(stop); });
    } catch (const std::system_error&) {
      may_write_back_ = false;  // no thread is available, so the sync at the end does all of it
    }
  }
  grown_.notify_one();
}

void GrowingFile::reserve_ahead(std::uint64_t end) {
  while (may_reserve_ && reserved_ < end + kPiece / 2) {
    reserved_ = std::max(reserved_, end);
    may_reserve_ = free_disk_bytes(folder_) >= kLeastFree * kPiece &&
                   ::fallocate(file_.descriptor(), FALLOC_FL_KEEP_SIZE,
                               static_cast<off_t>(reserved_), static_cast<off_t>(kPiece)) == 0;
    reserved_ += kPiece;
  }
}

void GrowingFile::write_back(const std::stop_token& stop) {
  std::uint64_t begun = 0;
  std::unique_lock lock(mutex_);
  while (grown_.wait(lock, stop, [&] { return written_ >= begun + kPiece; })) {
    const std::uint64_t first = std::exchange(begun, written_);
    lock.unlock();
    ::sync_file_range(file_.descriptor(), static_cast<off_t>(first),
                      static_cast<off_t>(begun - first), SYNC_FILE_RANGE_WRITE);
    lock.lock();
    if (stop.stop_requested()) return;
  }
}

void GrowingFile::trim() {
  if (reserved_ == 0) return;
  // Truncating the file to its own size frees the blocks after it. Where this fails they stay
  // reserved.
  if (::ftruncate(file_.descriptor(), static_cast<off_t>(file_.size_bytes())) != 0) return;
}

/// Creates a dataset of points: [cells, cell_points], in chunks of [1, cell_points], packed by
/// scale-offset.
template <typename Number>
hdf5::Id create_packed(const hdf5::Id& group, const char* name, std::uint64_t cells,
                       std::uint32_t cell_points) {
  const std::array<hsize_t, 2> size{cells, cell_points};
  const std::array<hsize_t, 2> chunk{1, cell_points};
  const hdf5::Id space(H5Screate_simple(2, size.data(), nullptr), H5Sclose, "HDF5 dataspace");
  const hdf5::Id list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "HDF5 property list");
  const hid_t type = hdf5::file_type<Number>();
  hdf5::check(H5Pset_obj_track_times(list.get(), false), "HDF5 object times");
  if (cells > 0) {
    hdf5::check(H5Pset_chunk(list.get(), 2, chunk.data()), "HDF5 chunk size");
    hdf5::check(H5Pset_fill_value(list.get(), type, nullptr), "HDF5 undefined fill value");
    hdf5::check(H5Pset_fill_time(list.get(), H5D_FILL_TIME_NEVER), "HDF5 fill time");
    hdf5::check(H5Pset_scaleoffset(list.get(), H5Z_SO_INT, H5Z_SO_INT_MINBITS_DEFAULT),
                "HDF5 scale-offset");
  }
  return {H5Dcreate2(group.get(), name, type, space.get(), H5P_DEFAULT, list.get(), H5P_DEFAULT),
          H5Dclose, std::string("create dataset ") + name};
}

void write_withheld(const hdf5::Id& file, const StoreWithheld& withheld) {
  hdf5::write_number(file, kWithheldPoints, withheld.points);
  if (withheld.kept) return;
  ColumnHashes hashes;
  hashes.add(std::array{withheld.points});
  hashes.add(coordinates_of(withheld.cubes));
  hdf5::write_dataset<std::int32_t>(file, kWithheld, coordinates_of(withheld.cubes), 3);
  hdf5::write_number(file, kWithheldHash, hashes.digest());
}

void write_corridor(const hdf5::Id& file, const StoreCorridor& near) {
  const Box& whole = near.whole;
  const std::array box{whole.lo.x, whole.lo.y, whole.lo.z, whole.hi.x, whole.hi.y, whole.hi.z};
  const std::array counts{near.left_out, near.unread, near.unread_bytes, near.passed_over};
  hdf5::write_number(file, kNearWithin, near.within);
  hdf5::write_attribute<double>(file, kNearWhole, box);
  hdf5::write_attribute<std::uint64_t>(file, kNearCounts, counts);
  hdf5::write_number(file, kNearHash, hash_of(near));
  const hdf5::Id group = hdf5::create_group(file, kNearGroup);
  hdf5::write_dataset<double>(group, kNearPath, numbers_of(near.path), 3);
}

/// Writes the attributes and /sources, whose datasets are the first of `hashes`.
void write_metadata(const hdf5::Id& file, const StoreMetadata& metadata, ColumnHashes& hashes) {
  hdf5::write_attribute(file, "format", kStoreFormat);
  hdf5::write_number(file, "version", kStoreVersion);
  hdf5::write_number(file, "point_count", metadata.point_count);
  hdf5::write_number(file, "input_points", metadata.input_points);
  hdf5::write_number(file, "cell_points", metadata.cell_points);
  hdf5::write_number(file, "points_hash", metadata.points_hash);
  hdf5::write_attribute<double>(file, "scale", metadata.quantisation.scale);
  hdf5::write_attribute<double>(file, "offset", metadata.quantisation.offset);
  hdf5::write_attribute<double>(file, "steps", metadata.steps);
  hdf5::write_attribute(file, "layout", metadata.layout);
  hdf5::write_attribute(file, "options", metadata.options);
  hdf5::write_attribute(file, "length_unit", to_string(metadata.unit));
  hdf5::write_attribute(file, "crs_wkt", metadata.crs_wkt);
  if (metadata.height_unit != 0) hdf5::write_number(file, kHeightUnit, metadata.height_unit);

  if (metadata.withheld) write_withheld(file, *metadata.withheld);
  if (metadata.near) write_corridor(file, *metadata.near);
  write_scan_dates(file, metadata.dates);
  if (!metadata.warnings.empty()) write_warnings(file, metadata.warnings);

  std::vector<std::uint8_t> names;
  std::vector<std::uint64_t> bytes, contents;
  for (const SourceFile& source : metadata.sources) {
    names.insert(names.end(), source.name.begin(), source.name.end());
    names.push_back(0);
    bytes.push_back(source.bytes);
    contents.push_back(source.xxh64);
  }
  const hdf5::Id group = hdf5::create_group(file, "sources");
  hdf5::write_dataset<std::uint8_t>(group, "names", names);
  hdf5::write_dataset<std::uint64_t>(group, "bytes", bytes);
  hdf5::write_dataset<std::uint64_t>(group, "xxh64", contents);
  if (!metadata.source_points.empty()) {
    hdf5::write_dataset<std::uint64_t>(group, kSourcePoints, metadata.source_points);
  }
  hashes.add(names);
  hashes.add(bytes);
  hashes.add(contents);
}

/// Reserves room for exactly this many cells.
void reserve(CellIndex& index, std::uint64_t cells) {
  index.count.reserve(cells);
  index.box.reserve(6 * cells);
  index.address.reserve(4 * cells);
  index.bytes.reserve(4 * cells);
  index.xxh64.reserve(4 * cells);
}

/// A column of points that this store has.
struct Column {
  PointColumn of;
  hdf5::Id dataset;
  ColumnIndex index;
  const PackedColumn PackedCell::*packed;  ///< the part of a packed cell that it writes

  const PackedColumn& of_cell(const PackedCell& cell) const { return cell.*packed; }
};

}  // namespace

struct StoreWriter::State {
  std::filesystem::path path;
  StoreMetadata metadata;
  std::uint64_t promised_cells;
  hdf5::Id file;
  std::array<hdf5::Id, 4> points;
  CellIndex index;
  std::vector<Column> columns;
  File blocks;  ///< spools the rows of /blocks/box, which are too many to keep in memory
  std::uint64_t block_rows = 0;
  std::optional<GrowingFile> growth;
  ColumnHashes hashes;  ///< hashes of all datasets except those of /points

  std::uint64_t blocks_per_cell() const { return divide_up(metadata.cell_points, kBlockPoints); }

  void spool_blocks(std::span<const BlockBox> boxes) {
    static_assert(sizeof(BlockBox) == 6 * sizeof(std::uint16_t));
    std::vector<BlockBox> rows(boxes.begin(), boxes.end());
    rows.resize(blocks_per_cell());
    blocks.write(std::as_bytes(std::span(rows)));
    block_rows += rows.size();
  }

  void write_blocks() {
    constexpr std::uint64_t kPieceRows = 1 << 16;
    const hdf5::Id group = hdf5::create_group(file, "blocks");
    hdf5::Rows<std::uint16_t> dataset(group, "box", block_rows, 6);
    std::vector<std::uint16_t> piece;
    Xxh64Stream hash;
    for (std::uint64_t row = 0; row < block_rows; row += kPieceRows) {
      piece.resize(6 * std::min(kPieceRows, block_rows - row));
      blocks.read_at(row * sizeof(BlockBox), std::as_writable_bytes(std::span(piece)));
      dataset.write(row, piece);
      hash.update(std::as_bytes(std::span(piece)));
    }
    dataset.close();
    hashes.add_digest(hash.digest());
  }

  /// Writes a packed chunk at the end of the file and returns its address.
  std::uint64_t write_chunk(const hdf5::Id& dataset, std::uint64_t cell,
                            std::span<const std::byte> bytes) {
    const hid_t id = dataset.get();
    haddr_t address = 0;
    hdf5::check(H5Fget_eoa(file.get(), &address), path.string() + ": HDF5 end of file");
    const std::array<hsize_t, 2> at{cell, 0};
    hdf5::check(H5Dwrite_chunk(id, H5P_DEFAULT, 0, at.data(), bytes.size(), bytes.data()),
                path.string() + ": cannot write");
    if (cell == 0) {  // HDF5 also allocates the index of chunks, perhaps before the chunk
      unsigned mask = 0;
      hsize_t size = 0;
      hdf5::check(H5Dget_chunk_info_by_coord(id, at.data(), &mask, &address, &size),
                  path.string() + ": HDF5 address of a chunk");
    }
    growth->written(address + bytes.size());
    return address;
  }

  template <typename Number>
  void add_column(const PointColumn& of, PackedColumn PackedCell::*packed) {
    const hdf5::Id group = hdf5::create_group(file, of.group);
    columns.push_back(
        {of,
         create_packed<Number>(group, of.dataset, promised_cells, metadata.cell_points),
         {},
         packed});
    columns.back().index.reserve(promised_cells);
  }

  void write_to(Column& column, const PackedCell& packed, std::uint64_t cell) {
    const PackedColumn& values = column.of_cell(packed);
    column.index.address.push_back(write_chunk(column.dataset, cell, values.bytes));
    column.index.bytes.push_back(static_cast<std::uint32_t>(values.bytes.size()));
    column.index.xxh64.push_back(values.xxh64);
  }

  void write_columns() {
    for (Column& column : columns) {
      if (column.of.group == kClassColumn.group) {
        write_classes(file, *metadata.classes, column.index);
      } else {
        write_origins(file, *metadata.origins, column.index);
      }
      column.dataset.close(path.string() + ": cannot write");
    }
  }

  struct WrittenChunk {
    std::size_t cell;
    std::uint64_t address;
    std::uint32_t bytes;
    std::uint64_t hash;
  };

  /// The written chunks by number: x, y, z and source of each cell, and after all of these the
  /// chunks of one column after the other.
  WrittenChunk written(std::size_t chunk) const {
    const std::size_t points_end = index.bytes.size();
    if (chunk < points_end) {
      return {chunk / 4, index.address[chunk], index.bytes[chunk], index.xxh64[chunk]};
    }
    const std::size_t cells = points_end / 4;
    const std::size_t cell = (chunk - points_end) % cells;
    const ColumnIndex& of = columns[(chunk - points_end) / cells].index;
    return {cell, of.address[cell], of.bytes[cell], of.xxh64[cell]};
  }

  void confirm_address(const File& reread, const WrittenChunk& chunk) const {
    const auto bytes = std::make_unique_for_overwrite<std::byte[]>(chunk.bytes);
    const std::span<std::byte> read(bytes.get(), chunk.bytes);
    reread.read_at(chunk.address, read);
    if (xxh64(read) == chunk.hash) return;
    throw ResourceError(path.string() + ": a chunk of cell " + std::to_string(chunk.cell) +
                        " read back differs from what was written at byte " +
                        std::to_string(chunk.address));
  }

  void confirm_addresses() const {
    const File reread = File::open_for_reading(path);
    for_each_parallel(index.bytes.size() / 4 * (4 + columns.size()),
                      [&](std::size_t chunk) { confirm_address(reread, written(chunk)); });
  }
};

void hash_chunks(PackedCell& packed) {
  for (std::size_t i = 0; i < packed.chunks.size(); ++i) packed.xxh64[i] = xxh64(packed.chunks[i]);
  for (PackedColumn* column : {&packed.classes, &packed.origins}) {
    if (!column->bytes.empty()) column->xxh64 = xxh64(column->bytes);
  }
}

StoreWriter::StoreWriter(const std::filesystem::path& path, const StoreMetadata& metadata,
                         std::uint64_t cells)
    : state_(new State{.path = path,
                       .metadata = metadata,
                       .promised_cells = cells,
                       .file = {},
                       .points = {},
                       .index = {},
                       .columns = {},
                       .blocks = File::create_temporary(folder_of(path)),
                       .growth = {},
                       .hashes = {}}) {
  hdf5::naming(path.string(), [&] { create(cells); });
}

void StoreWriter::create(std::uint64_t cells) {
  const StoreMetadata& metadata = state_->metadata;
  reserve(state_->index, cells);
  state_->file = hdf5::create_file(state_->path);
  state_->growth.emplace(state_->path);
  write_metadata(state_->file, metadata, state_->hashes);
  const hdf5::Id group = hdf5::create_group(state_->file, "points");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    state_->points[axis] =
        create_packed<std::int32_t>(group, kPointDatasets[axis], cells, metadata.cell_points);
  }
  state_->points[3] =
      create_packed<std::uint64_t>(group, kPointDatasets[3], cells, metadata.cell_points);
  if (metadata.classes) {
    state_->add_column<std::uint8_t>(kClassColumn, &PackedCell::classes);
  }
  if (metadata.origins) {
    state_->add_column<std::uint32_t>(kOriginColumn, &PackedCell::origins);
  }
}

StoreWriter::~StoreWriter() {
  const hdf5::QuietScope quiet;
  state_.reset();
}

void StoreWriter::append(const PackedCell& packed) {
  const hdf5::QuietScope quiet;
  State& state = *state_;
  CellIndex& index = state.index;
  const std::uint64_t cell = index.count.size();
  if (cell >= state.promised_cells) throw std::logic_error("more cells than promised");
  for (int i = 0; i < 4; ++i) {
    const std::vector<std::byte>& chunk = packed.chunks[static_cast<std::size_t>(i)];
    index.address.push_back(
        state.write_chunk(state.points[static_cast<std::size_t>(i)], cell, chunk));
    index.bytes.push_back(static_cast<std::uint32_t>(chunk.size()));
    index.xxh64.push_back(packed.xxh64[static_cast<std::size_t>(i)]);
  }
  for (Column& column : state.columns) state.write_to(column, packed, cell);
  index.count.push_back(packed.cell.count);
  index.box.insert(index.box.end(), packed.cell.box.lo, packed.cell.box.lo + 3);
  index.box.insert(index.box.end(), packed.cell.box.hi, packed.cell.box.hi + 3);
  state.spool_blocks(packed.blocks);
}

void StoreWriter::finish(const std::vector<TopNode>& tree) {
  hdf5::naming(state_->path.string(), [&] { write_index(tree); });
}

void StoreWriter::confirm() const { state_->confirm_addresses(); }

void StoreWriter::write_index(const std::vector<TopNode>& tree) {
  State& state = *state_;
  if (state.index.count.size() != state.promised_cells) {
    throw std::logic_error("fewer cells than promised");
  }
  std::vector<std::uint32_t> nodes;
  for (const TopNode& node : tree) {
    nodes.insert(nodes.end(), {node.first_cell, node.cell_count, node.right});
  }
  {
    const hdf5::Id cells = hdf5::create_group(state.file, "cells");
    hdf5::write_dataset<std::uint32_t>(cells, "count", state.index.count);
    hdf5::write_dataset<std::int32_t>(cells, "box", state.index.box, 6);
    hdf5::write_dataset<std::uint64_t>(cells, "address", state.index.address, 4);
    hdf5::write_dataset<std::uint32_t>(cells, "bytes", state.index.bytes, 4);
    hdf5::write_dataset<std::uint64_t>(cells, "xxh64", state.index.xxh64, 4);
    add_index(state.index, state.hashes);
    state.write_blocks();
    const hdf5::Id group = hdf5::create_group(state.file, "tree");
    hdf5::write_dataset<std::uint32_t>(group, "nodes", nodes, 3);
    state.hashes.add(nodes);
  }
  state.write_columns();
  hdf5::write_number(state.file, "index_hash", state.hashes.digest());
  hdf5::write_number(state.file, "complete", std::uint32_t{1});
  for (hdf5::Id& dataset : state.points) dataset.close(state.path.string() + ": cannot write");
  state.file.close(state.path.string() + ": cannot write");
  state.growth->trim();
  state.growth.reset();
}

}  // namespace clearway
