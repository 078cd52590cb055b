#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "clearway/vec3.hpp"
#include "io/files/json.hpp"

/// HDF5 files of tables, the form of stores, results, sections and the places of a ledger
/// (docs/design/table-file.md). Their bytes depend on their contents alone.
namespace clearway {

namespace hdf5 {
class Id;
}

/// How a kind of file is recognised, and the words about files that are not of it.
struct TableFileKind {
  const char* format;     ///< the attribute `format`, such as "clearway section"
  std::uint32_t version;  ///< the attribute `version`
  const char* is_a;       ///< as in "a section"
  const char* made_by;    ///< as in "clearway section find"
  const char* again;      ///< what to do with one of another version, as in "run it again"
};

enum class NumberType : std::uint8_t {
  kUint8,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat64
};

/// A column of a table, and the form of its values.
struct TableColumn {
  std::string name;  ///< within its group
  NumberType type;
  std::uint32_t numbers = 0;  ///< numbers of a value; 0: one, without a second dimension

  std::size_t value_bytes() const;
};

/// The number of which a value consists, and how many of them; 0 for a number itself.
template <typename Value>
struct NumbersOf {
  using Number = Value;
  static constexpr std::uint32_t kCount = 0;
};
template <>
struct NumbersOf<Vec3> {
  using Number = double;
  static constexpr std::uint32_t kCount = 3;
};
template <typename T, std::size_t N>
struct NumbersOf<std::array<T, N>> {
  using Number = T;
  static constexpr std::uint32_t kCount = N;
};

/// A column whose values are `Value`: numbers, points, or arrays of numbers.
template <typename Value>
TableColumn table_column(std::string name) {
  using Number = typename NumbersOf<Value>::Number;
  constexpr std::uint32_t kCount = NumbersOf<Value>::kCount;
  static_assert(sizeof(Value) == std::max<std::size_t>(kCount, 1) * sizeof(Number));
  constexpr auto kType = [] {
    if constexpr (std::is_same_v<Number, std::uint8_t>) return NumberType::kUint8;
    if constexpr (std::is_same_v<Number, std::uint16_t>) return NumberType::kUint16;
    if constexpr (std::is_same_v<Number, std::int32_t>) return NumberType::kInt32;
    if constexpr (std::is_same_v<Number, std::uint32_t>) return NumberType::kUint32;
    if constexpr (std::is_same_v<Number, std::int64_t>) return NumberType::kInt64;
    if constexpr (std::is_same_v<Number, std::uint64_t>) return NumberType::kUint64;
    if constexpr (std::is_same_v<Number, double>) return NumberType::kFloat64;
  }();
  return {std::move(name), kType, kCount};
}

/// Rows of a table that are encoded and written together. This number and that of the rows decide
/// the order of the writes, and with it every address in the file.
inline constexpr std::size_t kPieceRows = 1 << 16;

/// The values of some rows in a column, as bytes.
using ColumnBytes = std::span<const std::byte>;

/// Up to kPieceRows consecutive rows of a table in the form in which the file stores them. Any
/// thread may fill and seal one.
class TablePiece {
 public:
  std::size_t size() const { return rows_; }
  /// Appends the values of the same `rows` rows in all columns, in the order of the columns.
  void append(std::size_t rows, std::span<const ColumnBytes> columns);
  /// Fills the last chunks with zeros, and computes checksums and hashes. Called after the last
  /// append().
  void seal();

 private:
  friend class TableWriter;

  struct Chunk {
    std::unique_ptr<std::byte[]> bytes;
    std::size_t used = 0;
    std::uint64_t xxh64 = 0;
  };
  struct Column {
    std::size_t value_bytes, chunk_bytes;
    std::vector<Chunk> chunks = {};
  };

  std::vector<Column> columns_;
  std::size_t rows_ = 0;
};

class TableFileWriter;

/// Writes a table front to back. A TableFileWriter owns it.
class TableWriter {
 public:
  TableWriter(TableFileWriter& file, std::string group, std::vector<TableColumn> columns,
              std::uint64_t rows);
  ~TableWriter();

  /// An empty piece for the caller to fill and seal. Thread safe.
  TablePiece new_piece() const;
  /// Writes a sealed piece. All but the last of a table have kPieceRows rows. Throws
  /// std::logic_error for other pieces, for more rows than promised, and where a table before this
  /// one lacks rows.
  void write(TablePiece& piece);
  /// Writes any number of rows, as TablePiece::append() takes them, in whole pieces.
  void append(std::size_t rows, std::span<const ColumnBytes> columns);
  /// Writes rows given as vectors or spans of the values of each column.
  template <typename First, typename... Others>
  void append_values(const First& first, const Others&... others) {
    const std::array<ColumnBytes, 1 + sizeof...(Others)> bytes{std::as_bytes(std::span(first)),
                                                               std::as_bytes(std::span(others))...};
    append(std::size(first), bytes);
  }

 private:
  friend class TableFileWriter;
  struct Dataset;

  /// Completes the tables before this one. Throws std::logic_error where rows are out of order.
  void begin_rows(std::size_t rows);
  void write_piece(TablePiece& piece);
  void complete();

  TableFileWriter& file_;
  std::string group_;
  std::vector<TableColumn> columns_;
  std::vector<Dataset> datasets_;
  std::uint64_t promised_, written_ = 0;
  TablePiece buffered_;
};

/// Writes a file of tables to a path of its own, which the caller publishes. All calls come from
/// one thread, except that others may fill pieces. A failing disk throws ResourceError.
class TableFileWriter {
 public:
  TableFileWriter(const std::filesystem::path& path, const TableFileKind& kind);
  ~TableFileWriter();

  /// Begins a table with so many rows. Tables are written one after the other. The reference stays
  /// valid.
  TableWriter& add_table(std::string group, std::vector<TableColumn> columns, std::uint64_t rows);

  /// Writes a whole column that is a table of its own.
  template <typename Values>
  void add_column(const std::string& group, const std::string& name, const Values& values) {
    const std::span all(values);
    using Value = typename decltype(all)::value_type;
    add_table(group, {table_column<Value>(name)}, all.size()).append_values(all);
  }

  /// Repeats a fact as an attribute, for readers that know HDF5 alone.
  void note(const char* attribute, std::span<const double> numbers);
  void note(const char* attribute, bool flag);

  /// Writes the facts and closes the file. Throws std::logic_error unless all tables have their
  /// promised rows.
  void finish(Json facts);

  /// The open file, for objects that are no tables.
  const hdf5::Id& file() const;
  /// Starts the transfer to the disk of what was written to such objects, while more is computed.
  void written();

 private:
  friend class TableWriter;
  struct State;
  std::unique_ptr<State> state_;
};

/// A column of an open file. One thread at a time reads a file.
class StoredColumn {
 public:
  std::uint64_t rows() const { return rows_; }
  /// Hash of the hashes of all its chunks: equal for equal values in columns of equal types.
  std::uint64_t hash() const;

  /// Checks values that were read: the first of them is that of row `first`. Throws InputError;
  /// thread safe.
  using Check = std::function<void(std::uint64_t first, std::span<const std::byte> values)>;

  /// Reads the rows from `first` on, as many as fit exactly into `out`, on the threads of the
  /// caller's arena. Throws InputError for a damaged chunk, or as `check` does, of several for the
  /// one with the lowest row. check: called for the rows of each chunk.
  void read_bytes(std::uint64_t first, std::span<std::byte> out, const Check& check = {}) const;

 protected:
  friend class TableFile;
  struct Source;

  std::shared_ptr<const Source> source_;
  std::uint64_t rows_ = 0;
};

/// A column whose values are `Value`.
template <typename Value>
class StoredValues : public StoredColumn {
 public:
  explicit StoredValues(StoredColumn column) : StoredColumn(std::move(column)) {}

  void read(std::uint64_t first, std::span<Value> out) const {
    read_bytes(first, std::as_writable_bytes(out));
  }
  /// check(first row, values): see Check.
  template <typename CheckValues>
  void read(std::uint64_t first, std::span<Value> out, const CheckValues& check) const {
    read_bytes(first, std::as_writable_bytes(out),
               [&check](std::uint64_t row, std::span<const std::byte> bytes) {
                 check(row, std::span(reinterpret_cast<const Value*>(bytes.data()),
                                      bytes.size() / sizeof(Value)));
               });
  }
  std::vector<Value> all() const {
    std::vector<Value> values(rows());
    read(0, values);
    return values;
  }
};

/// A file of tables that is read.
class TableFile {
 public:
  /// Opens a file of one of these kinds. Throws InputError where it is none, is of another version
  /// or not complete, or where its header is damaged.
  TableFile(const std::filesystem::path& path, std::span<const TableFileKind> kinds);
  TableFile(const std::filesystem::path& path, const TableFileKind& kind)
      : TableFile(path, std::span(&kind, 1)) {}
  TableFile(TableFile&&) noexcept;
  TableFile& operator=(TableFile&& other) noexcept;
  ~TableFile();

  const std::string& name() const;  ///< path of the file, for messages
  std::size_t kind() const;         ///< index of the kind that it has
  const Json& header() const;

  /// Opens a column by its path, such as "collisions/source". Throws InputError where it is
  /// missing, or has another form than was written.
  template <typename Value>
  StoredValues<Value> column(const std::string& path) const {
    return StoredValues<Value>(open(path, table_column<Value>(path)));
  }
  template <typename Value>
  std::vector<Value> all(const std::string& path) const {
    return column<Value>(path).all();
  }

  /// The open file, for objects that are no tables.
  const hdf5::Id& file() const;

 private:
  StoredColumn open(const std::string& path, const TableColumn& form) const;

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace clearway
