#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "io/hdf5/hdf5.hpp"
#include "io/result/as_numbers.hpp"
#include "io/result/column_hashes.hpp"

namespace clearway {

/// A dataset of numbers or points, and its rows not yet written.
template <typename Value>
class ResultColumn {
 public:
  ResultColumn(const hdf5::Id& group, const char* name, std::uint64_t rows)
      : dataset_(group, name, rows, kIsPoints ? 3 : 0) {}

  void append(std::span<const Value> values) {
    buffer_.insert(buffer_.end(), values.begin(), values.end());
  }

  void flush(std::uint64_t first_row) {
    hash_.update(std::as_bytes(std::span<const Value>(buffer_)));
    if constexpr (kIsPoints) {
      dataset_.write(first_row, as_numbers(std::span<const Vec3>(buffer_)));
    } else {
      dataset_.write(first_row, buffer_);
    }
    buffer_.clear();
  }

  std::uint64_t digest() const { return hash_.digest(); }  ///< of the rows written

 private:
  static constexpr bool kIsPoints = std::is_same_v<Value, Vec3>;
  using Number = std::conditional_t<kIsPoints, double, Value>;

  hdf5::Rows<Number> dataset_;
  std::vector<Value> buffer_;
  Xxh64Stream hash_;
};

/// A group of datasets with equally many rows, which are written in pieces.
template <typename... Values>
class ResultTable {
 public:
  using Names = std::array<const char*, sizeof...(Values)>;

  /// A column without a name is not written.
  ResultTable(const hdf5::Id& file, const char* group, const Names& names, std::uint64_t rows)
      : group_(hdf5::create_group(file, group)), promised_(rows) {
    each([&](auto& column, std::size_t i) {
      if (names[i] != nullptr) column.emplace(group_, names[i], rows);
    });
  }

  /// The next rows; a column that is not written has none. Throws std::logic_error for spans of
  /// unequal lengths and more rows than promised.
  void append(std::span<const Values>... values) {
    const auto spans = std::tuple(values...);
    const std::size_t rows = std::get<0>(spans).size();
    each(
        [&](auto& column, std::size_t, const auto& span) {
          if (span.size() != (column ? rows : 0)) {
            throw std::logic_error("ResultWriter: rows of unequal lengths");
          }
        },
        spans);
    if (rows > promised_ - written_ - buffered_) {
      throw std::logic_error("ResultWriter: more rows than promised");
    }
    for (std::size_t from = 0; from < rows;) {
      const std::size_t count = std::min(rows - from, kBufferRows - buffered_);
      each(
          [&](auto& column, std::size_t, const auto& span) {
            if (column) column->append(span.subspan(from, count));
          },
          spans);
      from += count;
      buffered_ += count;
      if (buffered_ == kBufferRows) flush();
    }
  }

  void flush() {
    each([&](auto& column, std::size_t) {
      if (column) column->flush(written_);
    });
    written_ += std::exchange(buffered_, 0);
  }

  void check_complete() const {
    if (written_ + buffered_ == promised_) return;
    throw std::logic_error("ResultWriter: " + std::to_string(written_ + buffered_) +
                           " rows written, " + std::to_string(promised_) + " promised");
  }

  std::uint64_t hash() {
    ColumnHashes hashes;
    each([&](auto& column, std::size_t) {
      if (column) hashes.add_digest(column->digest());
    });
    return hashes.digest();
  }

 private:
  /// A multiple of every dataset's chunk rows. The order of the writes, and with it every address
  /// in the file, follows from it and the number of rows, not from how they were appended.
  static constexpr std::size_t kBufferRows = 1 << 16;

  /// Calls visit(column, its number, and what else has a part for each column).
  template <typename Visit, typename... Others>
  void each(Visit visit, const Others&... others) {
    const auto at = [&]<std::size_t... I>(std::index_sequence<I...>) {
      const auto one = [&]<std::size_t K>(std::integral_constant<std::size_t, K>) {
        visit(std::get<K>(columns_), K, std::get<K>(others)...);
      };
      (one(std::integral_constant<std::size_t, I>()), ...);
    };
    at(std::index_sequence_for<Values...>());
  }

  hdf5::Id group_;
  std::uint64_t promised_, written_ = 0;
  std::size_t buffered_ = 0;
  std::tuple<std::optional<ResultColumn<Values>>...> columns_;
};

}  // namespace clearway
