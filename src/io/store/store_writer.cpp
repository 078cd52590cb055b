#include "io/store/store_writer.hpp"

#include <hdf5.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "clearway/error.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "io/files/file.hpp"
#include "io/files/fletcher32.hpp"
#include "io/files/hdf5.hpp"
#include "io/files/header_values.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/files/xxh64.hpp"
#include "io/store/store_metadata.hpp"

namespace clearway {
namespace {

/// Creates a dataset with a row and a chunk for each cell: cell_points values, packed by
/// scale-offset, or the numbers of its block boxes, which only have a checksum.
hdf5::Id create_chunked(const hdf5::Id& file, const std::string& group, std::size_t column,
                        std::uint64_t cells, std::uint32_t cell_points) {
  hdf5::require_group(file, group);
  const std::array types{H5T_STD_I32LE, H5T_STD_I32LE, H5T_STD_I32LE, H5T_STD_U64LE,
                         H5T_STD_U16LE, H5T_STD_U8LE,  H5T_STD_U32LE};
  const bool is_packed = column != kBlocks;
  const hsize_t values = is_packed ? cell_points : 6 * divide_up(cell_points, kBlockPoints);
  const std::array<hsize_t, 2> size{cells, values};
  const std::array<hsize_t, 2> chunk{1, values};
  const hdf5::Id space(H5Screate_simple(2, size.data(), nullptr), H5Sclose, "HDF5 dataspace");
  const hdf5::Id list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "HDF5 property list");
  hdf5::check(H5Pset_obj_track_times(list.get(), false), "HDF5 object times");
  if (cells > 0) {
    hdf5::check(H5Pset_chunk(list.get(), 2, chunk.data()), "HDF5 chunk size");
    hdf5::check(H5Pset_fill_value(list.get(), types[column], nullptr), "HDF5 undefined fill value");
    hdf5::check(H5Pset_fill_time(list.get(), H5D_FILL_TIME_NEVER), "HDF5 fill time");
    hdf5::check(is_packed ? H5Pset_scaleoffset(list.get(), H5Z_SO_INT, H5Z_SO_INT_MINBITS_DEFAULT)
                          : H5Pset_fletcher32(list.get()),
                "HDF5 filter");
  }
  const std::string path = group + "/" + kPointColumnNames[column];
  return {H5Dcreate2(file.get(), path.c_str(), types[column], space.get(), H5P_DEFAULT, list.get(),
                     H5P_DEFAULT),
          H5Dclose, "create dataset " + path};
}

}  // namespace

struct StoreWriter::State {
  State(const std::filesystem::path& path_of_file, const StoreMetadata& facts, std::uint64_t cells)
      : path(path_of_file), metadata(facts), promised_cells(cells), file(path, kStoreKind) {
    hdf5::naming(path.string(), [&] {
      count.reserve(cells);
      box.reserve(cells);
      for (std::size_t group = 0; group < kChunkGroups.size(); ++group) {
        const auto& [name, first, columns] = kChunkGroups[group];
        if (!has(first)) continue;
        for (std::size_t column = first; column < first + columns; ++column) {
          datasets[column] = create_chunked(file.file(), group == 0 ? "points" : name, column,
                                            cells, facts.cell_points);
        }
        chunks[group].address.reserve(columns * cells);
        chunks[group].bytes.reserve(columns * cells);
        chunks[group].xxh64.reserve(columns * cells);
      }
    });
  }

  bool has(std::size_t column) const {
    return column < kClass ||
           (column == kClass ? metadata.classes.has_value() : metadata.origins.has_value());
  }

  /// Writes a packed chunk at the end of the file and returns its address.
  std::uint64_t write_chunk(const hdf5::Id& dataset, std::uint64_t cell,
                            std::span<const std::byte> bytes) {
    haddr_t address = 0;
    hdf5::check(H5Fget_eoa(file.file().get(), &address), "HDF5 end of file");
    const std::array<hsize_t, 2> at{cell, 0};
    hdf5::check(
        H5Dwrite_chunk(dataset.get(), H5P_DEFAULT, 0, at.data(), bytes.size(), bytes.data()),
        "cannot write");
    if (cell == 0) {  // HDF5 also allocates the index of chunks, perhaps before the chunk
      unsigned mask = 0;
      hsize_t size = 0;
      hdf5::check(H5Dget_chunk_info_by_coord(dataset.get(), at.data(), &mask, &address, &size),
                  "HDF5 address of a chunk");
    }
    file.written();
    return address;
  }

  void append(const PackedCell& packed) {
    if (count.size() >= promised_cells) throw std::logic_error("more cells than promised");
    for (std::size_t group = 0; group < kChunkGroups.size(); ++group) {
      const auto& [name, first, columns] = kChunkGroups[group];
      for (std::size_t column = first; column < first + columns && has(column); ++column) {
        const std::vector<std::byte>& chunk = packed.chunks[column];
        chunks[group].address.push_back(write_chunk(datasets[column], count.size(), chunk));
        chunks[group].bytes.push_back(static_cast<std::uint32_t>(chunk.size()));
        chunks[group].xxh64.push_back(packed.xxh64[column]);
      }
    }
    count.push_back(packed.cell.count);
    box.push_back(packed.cell.box);
  }

  void write_index(const std::vector<TopNode>& tree) {
    if (count.size() != promised_cells) throw std::logic_error("fewer cells than promised");
    const auto& [address, bytes, xxh64] = chunks[0];
    file.add_table("cells",
                   {table_column<std::uint32_t>("count"), table_column<QuantumBox>("box"),
                    table_column<std::array<std::uint64_t, 4>>("address"),
                    table_column<std::array<std::uint32_t, 4>>("bytes"),
                    table_column<std::array<std::uint64_t, 4>>("xxh64")},
                   promised_cells)
        .append_values(count, box, address, bytes, xxh64);
    file.add_column("tree", "nodes", tree);
    for (std::size_t group = 1; group < kChunkGroups.size(); ++group) {
      if (!has(kChunkGroups[group].first)) continue;
      file.add_table(kChunkGroups[group].name,
                     {table_column<std::uint64_t>("address"), table_column<std::uint32_t>("bytes"),
                      table_column<std::uint64_t>("xxh64")},
                     promised_cells)
          .append_values(chunks[group].address, chunks[group].bytes, chunks[group].xxh64);
    }
    if (metadata.origins) file.add_column("origins", "quanta", metadata.origins->quanta);
    if (metadata.withheld && !metadata.withheld->kept) {
      file.add_column("withheld", "cube", metadata.withheld->cubes);
    }
    if (metadata.near) file.add_column("near", "path", metadata.near->path);
  }

  void finish(const std::vector<TopNode>& tree) {
    write_index(tree);
    hdf5::naming(path.string(), [&] {
      for (hdf5::Id& dataset : datasets) dataset.close("cannot write");
    });
    file.note("scale", std::span(metadata.quantisation.scale));
    file.note("offset", std::span(metadata.quantisation.offset));
    file.finish(as_header(metadata));
  }

  void confirm_address(const File& reread, std::size_t column, std::size_t cell) const {
    const StoredChunk chunk = chunks.of(column, cell);
    const auto bytes = std::make_unique_for_overwrite<std::byte[]>(chunk.bytes);
    const std::span<std::byte> read(bytes.get(), chunk.bytes);
    reread.read_at(chunk.address, read);
    if (clearway::xxh64(read) == chunk.xxh64) return;
    throw ResourceError(path.string() + ": a chunk of cell " + std::to_string(cell) +
                        " read back differs from what was written at byte " +
                        std::to_string(chunk.address));
  }

  std::filesystem::path path;
  StoreMetadata metadata;
  std::uint64_t promised_cells;
  TableFileWriter file;
  std::array<hdf5::Id, kPointColumns> datasets;
  std::vector<std::uint32_t> count;  ///< of each cell
  std::vector<QuantumBox> box;
  ChunkIndexes chunks;
};

void seal_cell(PackedCell& packed, std::span<const BlockBox> blocks, std::uint32_t cell_points) {
  std::vector<std::byte>& boxes = packed.chunks[kBlocks];
  boxes.resize(block_chunk_bytes(cell_points));
  std::memcpy(boxes.data(), blocks.data(), blocks.size_bytes());
  seal_fletcher32(boxes);
  for (std::size_t i = 0; i < kPointColumns; ++i) packed.xxh64[i] = xxh64(packed.chunks[i]);
}

StoreWriter::StoreWriter(const std::filesystem::path& path, const StoreMetadata& metadata,
                         std::uint64_t cells)
    : state_(std::make_unique<State>(path, metadata, cells)) {}

StoreWriter::~StoreWriter() {
  const hdf5::QuietScope quiet;
  state_.reset();
}

void StoreWriter::append(const PackedCell& packed) {
  hdf5::naming(state_->path.string(), [&] { state_->append(packed); });
}

void StoreWriter::finish(const std::vector<TopNode>& tree) { state_->finish(tree); }

void StoreWriter::confirm() const {
  const File reread = File::open_for_reading(state_->path);
  for_each_parallel(state_->promised_cells, [&](std::size_t cell) {
    for (std::size_t column = 0; column < kPointColumns; ++column) {
      if (state_->has(column)) state_->confirm_address(reread, column, cell);
    }
  });
}

}  // namespace clearway
