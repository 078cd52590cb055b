#include "io/store/store_reader.hpp"

#include <atomic>

#include "clearway/error.hpp"
#include "io/system/input_error.hpp"
#include "io/system/xxh64.hpp"

namespace clearway {
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
      classes_checked_(index_.classes.address.size()) {}

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

std::array<PackedChunk<std::int32_t>, 3> StoreReader::coordinates(std::uint32_t cell) const {
  std::array<PackedChunk<std::int32_t>, 3> chunks;
  for (int axis = 0; axis < 3; ++axis) {
    chunks[static_cast<std::size_t>(axis)] =
        chunk<std::int32_t>(cell, kPointDatasets[axis], checked_chunk(cell, axis));
  }
  std::atomic_ref(checked_[cell]).store(1, std::memory_order_release);
  return chunks;
}

std::array<PackedChunk<std::int32_t>, 3> StoreReader::peek(std::uint32_t cell) const {
  std::array<PackedChunk<std::int32_t>, 3> chunks;
  for (int axis = 0; axis < 3; ++axis) {
    chunks[static_cast<std::size_t>(axis)] =
        chunk<std::int32_t>(cell, kPointDatasets[axis], checked_chunk(cell, axis));
  }
  return chunks;
}

PackedChunk<std::uint64_t> StoreReader::sources(std::uint32_t cell) const {
  return chunk<std::uint64_t>(cell, kPointDatasets[3], checked_chunk(cell, 3));
}

std::uint64_t StoreReader::source_of(std::uint32_t cell, std::uint32_t index) const {
  const std::atomic_ref checked(sources_checked_[cell]);
  if (checked.load(std::memory_order_acquire) == 0) {
    checked_chunk(cell, 3);
    checked.store(1, std::memory_order_release);
  }
  const std::size_t i = 4 * std::size_t{cell} + 3;
  const auto bytes = map_.bytes().subspan(index_.cells.address[i], index_.cells.bytes[i]);
  return chunk<std::uint64_t>(cell, kPointDatasets[3], bytes)[index];
}

PackedChunk<std::uint8_t> StoreReader::classes(std::uint32_t cell) const {
  const ClassIndex& index = index_.classes;
  const auto bytes = map_.bytes().subspan(index.address[cell], index.bytes[cell]);
  const std::atomic_ref checked(classes_checked_[cell]);
  if (checked.load(std::memory_order_acquire) == 0) {
    if (xxh64(bytes) != index.xxh64[cell])
      refuse_damaged(cell, kClassOfPoints, index.address[cell]);
    checked.store(1, std::memory_order_release);
  }
  return chunk<std::uint8_t>(cell, kClassOfPoints, bytes);
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
  for (int axis = 0; axis < 3; ++axis) {
    const auto part = parts[static_cast<std::size_t>(axis)];
    check_hash(cell, axis, part);
    chunks[static_cast<std::size_t>(axis)] = chunk<std::int32_t>(cell, kPointDatasets[axis], part);
  }
  std::atomic_ref(read_[cell]).store(1, std::memory_order_relaxed);
  return chunks;
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
  add(metadata().crs_wkt);
  if (has_classes()) add(index_.classes.xxh64);
  return hash.digest();
}

StoreReader::Touched StoreReader::touched() const {
  Touched touched;
  for (std::size_t cell = 0; cell < checked_.size(); ++cell) {
    if (checked_[cell] == 0 && read_[cell] == 0) continue;
    ++touched.cells;
    touched.bytes += packed_bytes(static_cast<std::uint32_t>(cell));
  }
  return touched;
}

std::uint64_t StoreReader::allocated_bytes() const {
  const auto bytes = [](const auto& values) { return values.capacity() * sizeof(values[0]); };
  return bytes(index_.cells.count) + bytes(index_.cells.box) + bytes(index_.cells.address) +
         bytes(index_.cells.bytes) + bytes(index_.cells.xxh64) + bytes(index_.top) + bytes(cells_) +
         bytes(tree_) + bytes(index_.blocks) + bytes(checked_) + bytes(read_) +
         bytes(sources_checked_) + bytes(index_.classes.address) + bytes(index_.classes.bytes) +
         bytes(index_.classes.xxh64) + bytes(classes_checked_);
}

}  // namespace clearway
