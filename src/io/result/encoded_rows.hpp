#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <tuple>
#include <type_traits>
#include <vector>

#include "io/files/stored_chunk.hpp"
#include "io/result/tables.hpp"

namespace clearway {

/// Number of rows of a table that are encoded together, a multiple of every dataset's chunk rows.
/// This number and the number of rows determine the order of the writes and with it every address
/// in the file.
inline constexpr std::size_t kEncodedRows = 1 << 16;

/// A chunk of a column as the file stores it.
struct EncodedChunk {
  std::unique_ptr<std::byte[]> bytes;
  std::size_t size = 0;  ///< bytes of the chunk, including the checksum
  /// Bytes taken by rows; after them the last chunk of a dataset is filled with zeros.
  std::size_t used_bytes = 0;

  std::span<const std::byte> stored() const { return {bytes.get(), size}; }
  std::span<const std::byte> values() const { return {bytes.get(), used_bytes}; }
};

/// Bytes that the chunks of a column with this many rows take in the file.
template <typename Value>
std::uint64_t stored_bytes(std::uint64_t rows) {
  if (rows == 0) return 0;
  const std::uint64_t chunk_rows = hdf5::rows_of_chunk(rows, sizeof(Value));
  const std::uint64_t chunks = (rows + chunk_rows - 1) / chunk_rows;
  return chunks * (chunk_rows * sizeof(Value) + hdf5::kChecksumBytes);
}

/// Up to kEncodedRows consecutive values of a column.
template <typename Value>
class EncodedColumn {
 public:
  explicit EncodedColumn(std::uint64_t table_rows)
      : chunk_bytes_(hdf5::rows_of_chunk(table_rows, sizeof(Value)) * sizeof(Value)) {}

  void add(std::span<const Value> values) {
    auto bytes = std::as_bytes(values);
    while (!bytes.empty()) {
      if (chunks_.empty() || chunks_.back().used_bytes == chunk_bytes_) begin_chunk();
      EncodedChunk& chunk = chunks_.back();
      const std::size_t count = std::min(bytes.size(), chunk_bytes_ - chunk.used_bytes);
      std::memcpy(chunk.bytes.get() + chunk.used_bytes, bytes.data(), count);
      chunk.used_bytes += count;
      bytes = bytes.subspan(count);
    }
  }

  void seal() {
    for (EncodedChunk& chunk : chunks_) {
      std::memset(chunk.bytes.get() + chunk.used_bytes, 0, chunk_bytes_ - chunk.used_bytes);
      hdf5::seal_chunk({chunk.bytes.get(), chunk.size});
    }
  }

  std::vector<EncodedChunk>& chunks() { return chunks_; }
  const std::vector<EncodedChunk>& chunks() const { return chunks_; }

 private:
  void begin_chunk() {
    const std::size_t size = chunk_bytes_ + hdf5::kChecksumBytes;
    chunks_.push_back({std::make_unique_for_overwrite<std::byte[]>(size), size, 0});
  }

  std::size_t chunk_bytes_;
  std::vector<EncodedChunk> chunks_;
};

/// An encoded column, or nothing where the result does not have it.
template <typename Value>
using OptionalColumn = std::optional<EncodedColumn<Value>>;

/// Consecutive rows of a table, encoded by any thread for ResultWriter to write.
template <typename Rows>
class EncodedRows {
 public:
  using Columns = PerColumn<Rows, OptionalColumn>;

  /// table_rows: number of rows of the whole table.
  EncodedRows(std::uint64_t table_rows, const ResultHeader& header) {
    for_each_column<Rows>(columns_, [&](const auto& column, auto& encoded) {
      if (column.is_in(header)) encoded.emplace(table_rows);
    });
  }

  std::size_t size() const { return size_; }

  /// Appends the rows `first` to `first + count - 1`, so that there are at most kEncodedRows in
  /// all. Throws std::logic_error for columns of unequal lengths, where those that are not written
  /// must be empty, and for sources of points that do not ascend.
  void add(const Rows& rows, std::size_t first, std::size_t count) {
    if (count > kEncodedRows - size_) throw std::logic_error("ResultWriter: too many rows at once");
    for_each_column<Rows>(columns_, [&](const auto& column, const auto& encoded) {
      if ((rows.*column.values).size() != (encoded ? rows.size() : 0)) {
        throw std::logic_error("ResultWriter: rows of unequal lengths");
      }
    });
    if constexpr (kHasSources) check_ascending(std::span(rows.source).subspan(first, count));
    for_each_column<Rows>(columns_, [&](const auto& column, auto& encoded) {
      if (encoded) encoded->add(std::span(rows.*column.values).subspan(first, count));
    });
    size_ += count;
  }
  void add(const Rows& rows) { add(rows, 0, rows.size()); }

  /// Fills the last chunk of each column with zeros and appends the checksums. Called after the
  /// last add().
  void seal() {
    std::apply([](auto&... column) { ((column ? column->seal() : void()), ...); }, columns_);
  }

  Columns& columns() { return columns_; }
  const Columns& columns() const { return columns_; }

  /// Whether sources must ascend, as they do in tables of points.
  static constexpr bool has_sources() { return kHasSources; }
  /// First and last source of the rows added so far; only for tables that have sources.
  std::uint64_t first_source() const { return first_source_; }
  std::uint64_t last_source() const { return last_source_; }

 private:
  static constexpr bool kHasSources = !std::is_same_v<Rows, ProfileRows> &&
                                      !std::is_same_v<Rows, UnseenCubes> &&
                                      !std::is_same_v<Rows, SweptCells>;

  void check_ascending(std::span<const std::uint64_t> sources) {
    for (std::size_t i = 0; i < sources.size(); ++i) {
      if (size_ + i > 0 && sources[i] <= last_source_) {
        throw std::logic_error("ResultWriter: rows not ascending by source");
      }
      last_source_ = sources[i];
    }
    if (size_ == 0 && !sources.empty()) first_source_ = sources.front();
  }

  Columns columns_;
  std::size_t size_ = 0;
  std::uint64_t first_source_ = 0, last_source_ = 0;
};

}  // namespace clearway
