#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include "clearway/vec3.hpp"
#include "io/hdf5/stored_chunk.hpp"

namespace clearway {

/// Number of rows of a table that are encoded together, a multiple of every dataset's chunk rows.
/// This number and the number of rows determine the order of the writes and with it every address
/// in the file.
inline constexpr std::size_t kEncodedRows = 1 << 16;

/// A chunk of a column as the file stores it.
struct EncodedChunk {
  std::unique_ptr<std::byte[]> bytes;
  std::size_t size = 0;  ///< bytes of the chunk, including the checksum
  /// Bytes taken by rows; behind them the last chunk of a dataset is filled with zeros.
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

/// Consecutive rows of a table, encoded by any thread for ResultWriter to write.
template <typename... Values>
class EncodedRows {
 public:
  using Columns = std::tuple<std::optional<EncodedColumn<Values>>...>;
  using Present = std::array<bool, sizeof...(Values)>;

  /// table_rows: number of rows of the whole table.
  EncodedRows(std::uint64_t table_rows, const Present& present) {
    std::size_t i = 0;
    each_column(columns_, [&](auto& column) {
      if (present[i++]) column.emplace(table_rows);
    });
  }

  std::size_t size() const { return rows_; }

  /// Appends rows, at most kEncodedRows in all; the span of a column that is not written is empty.
  /// Throws std::logic_error for spans of unequal lengths, and for sources that do not ascend where
  /// the first column holds sources.
  void add(std::span<const Values>... values) {
    const auto spans = std::tuple(values...);
    const std::size_t rows = std::get<0>(spans).size();
    each_column(columns_, [&, i = std::size_t{0}](const auto& column) mutable {
      const std::array lengths{values.size()...};
      if (lengths[i++] != (column ? rows : 0)) {
        throw std::logic_error("ResultWriter: rows of unequal lengths");
      }
    });
    if (rows > kEncodedRows - rows_) throw std::logic_error("ResultWriter: too many rows at once");
    if constexpr (kHasSources) check_ascending(std::get<0>(spans));
    const auto add_each = [&]<std::size_t... I>(std::index_sequence<I...>) {
      ((std::get<I>(columns_) ? std::get<I>(columns_)->add(std::get<I>(spans)) : void()), ...);
    };
    add_each(std::index_sequence_for<Values...>());
    rows_ += rows;
  }

  /// Fills the last chunk of each column with zeros and appends the checksums. Called after the
  /// last add().
  void seal() {
    each_column(columns_, [](auto& column) {
      if (column) column->seal();
    });
  }

  Columns& columns() { return columns_; }
  const Columns& columns() const { return columns_; }

  static constexpr bool has_sources() { return kHasSources; }
  /// First and last source of the rows added so far; only for tables whose first column holds
  /// sources.
  std::uint64_t first_source() const { return first_source_; }
  std::uint64_t last_source() const { return last_source_; }

 private:
  static constexpr bool kHasSources =
      std::is_same_v<std::tuple_element_t<0, std::tuple<Values...>>, std::uint64_t>;

  template <typename Tuple, typename Visit>
  static void each_column(Tuple& columns, Visit visit) {
    std::apply([&](auto&... column) { (visit(column), ...); }, columns);
  }

  void check_ascending(std::span<const std::uint64_t> sources) {
    for (std::size_t i = 0; i < sources.size(); ++i) {
      if (rows_ + i > 0 && sources[i] <= last_source_) {
        throw std::logic_error("ResultWriter: rows not ascending by source");
      }
      last_source_ = sources[i];
    }
    if (rows_ == 0 && !sources.empty()) first_source_ = sources.front();
  }

  Columns columns_;
  std::size_t rows_ = 0;
  std::uint64_t first_source_ = 0, last_source_ = 0;
};

using EncodedCollisions =
    EncodedRows<std::uint64_t, Vec3, std::uint32_t, std::uint32_t, std::uint32_t>;
using EncodedClearances = EncodedRows<std::uint64_t, Vec3, double, std::uint32_t, std::uint32_t>;

}  // namespace clearway
