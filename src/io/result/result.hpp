#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "io/files/table_file.hpp"
#include "io/result/result_header.hpp"
#include "io/result/tables.hpp"

namespace clearway {

inline constexpr std::uint32_t kResultVersion = 7;
/// A whole result, and a part, which no reader takes for a result.
inline constexpr TableFileKind kResultKinds[]{
    {"clearway result", kResultVersion, "a result", "clearway run", "run it again"},
    {"clearway part", kResultVersion, "a part of a result", "clearway run --shard",
     "run it again"}};

/// The values of the columns that a result with this header has. Throws std::logic_error where
/// others have values, or where their lengths differ.
template <typename Rows>
std::vector<ColumnBytes> bytes_of(const Rows& rows, const ResultHeader& header) {
  std::vector<ColumnBytes> columns;
  for_each_column<Rows>([&](const auto& column) {
    const auto& values = rows.*column.values;
    if (values.size() != (column.is_in(header) ? rows.size() : 0)) {
      throw std::logic_error("ResultWriter: rows of unequal lengths");
    }
    if (column.is_in(header)) columns.push_back(std::as_bytes(std::span(values)));
  });
  return columns;
}

/// Consecutive rows of a table, encoded by any thread for ResultWriter to write.
template <typename Rows>
class EncodedRows {
 public:
  EncodedRows(TablePiece piece, const ResultHeader& header)
      : piece_(std::move(piece)), header_(&header) {}

  std::size_t size() const { return piece_.size(); }

  /// Appends rows, so that there are at most kPieceRows in all. Throws std::logic_error for columns
  /// of unequal lengths, where those that are not written must be empty, and for rows out of order.
  void add(const Rows& rows) {
    piece_.append(rows.size(), bytes_of(rows, *header_));
    if (order_.take(rows) < rows.size()) throw std::logic_error("ResultWriter: rows out of order");
  }
  /// Called after the last add().
  void seal() { piece_.seal(); }

 private:
  friend class ResultWriter;

  TablePiece piece_;
  const ResultHeader* header_;
  OrderOf<Rows> order_;
};

/// Writes the tables that docs/design/result-format.md lists and the header asks for to a file of
/// its own, which the caller publishes. Its bytes depend on header and rows alone. Collisions come
/// first, then clearances, then the profile, then near points, then unseen cubes, then
/// swept cells. append() and write() throw std::logic_error for rows out of this order, for a table
/// that the header does not ask for, for more rows than promised, for rows that do not ascend and
/// for columns of unequal lengths, where a column that the header does not ask for must be empty. A
/// failing disk throws ResourceError.
///
/// Instead of appending rows, threads may encode them kPieceRows at a time; only the last rows of a
/// table may be fewer. The encoded rows are then written in order, by one thread at a time.
///
/// `Rows` is Collisions, Clearances, ProfileRows, Nearby, UnseenCubes or SweptCells.
class ResultWriter {
 public:
  /// Creates the file at `path`. collisions, clearances, near, unseen, swept: number of rows that
  /// will be written. The profile has one row per pose.
  ResultWriter(const std::filesystem::path& path, const ResultHeader& header,
               std::uint64_t collisions, std::uint64_t clearances = 0, std::uint64_t near = 0,
               std::uint64_t unseen = 0, std::uint64_t swept = 0);

  /// Appends any number of rows.
  template <typename Rows>
  void append(const Rows& rows) {
    OrderOf<Rows> order;
    check_follows(order.take(rows) == rows.size(), order);
    table<Rows>().append(rows.size(), bytes_of(rows, header_));
    std::get<Written<Rows>>(tables_).order = order;
  }

  /// Empty rows for the caller to fill and seal. Thread safe.
  template <typename Rows>
  EncodedRows<Rows> new_rows() const {
    return {table<Rows>().new_piece(), header_};
  }
  template <typename Rows>
  void write(EncodedRows<Rows>& rows) {
    check_follows(true, rows.order_);
    table<Rows>().write(rows.piece_);
    std::get<Written<Rows>>(tables_).order = rows.order_;
  }

  /// Writes the findings and closes the file. Throws std::logic_error unless as many rows as
  /// promised were appended.
  void finish(const ResultFindings& findings = {});

 private:
  template <typename Rows>
  struct Written {
    TableWriter* table = nullptr;  ///< null where the result does not have it
    OrderOf<Rows> order = {};
  };

  template <typename Rows>
  void begin(std::uint64_t rows);

  template <typename Rows>
  TableWriter& table() const {
    if (TableWriter* table = std::get<Written<Rows>>(tables_).table) return *table;
    throw std::logic_error(std::string("ResultWriter: no ") + Table<Rows>::kGroup);
  }

  /// Throws std::logic_error unless rows ascend, and with this order follow those before.
  template <typename Rows>
  void check_follows(bool ascend, const OrderOf<Rows>& order) const {
    if (ascend && order.follows(std::get<Written<Rows>>(tables_).order)) return;
    throw std::logic_error("ResultWriter: rows out of order");
  }

  ResultHeader header_;
  TableFileWriter file_;
  std::tuple<Written<Collisions>, Written<Clearances>, Written<ProfileRows>, Written<Nearby>,
             Written<UnseenCubes>, Written<SweptCells>>
      tables_;
};

/// Whether ResultReader accepts a part of a result in place of a whole one.
enum class Parts { kRefused, kAccepted };

/// Reads a result. No value leaves it that was not checked against the hash of its chunk. Throws
/// InputError when the file is not a complete result, is damaged, or holds rows that no run can
/// have found: source indices of points are strictly ascending and below
/// header().environment_points, poses are below header().poses, bodies below their number, and
/// distances at most what was asked for and below 0 only for models with solids.
///
/// `Rows` is Collisions, Clearances, ProfileRows, Nearby, UnseenCubes or SweptCells.
class ResultReader {
 public:
  explicit ResultReader(const std::filesystem::path& path, Parts parts = Parts::kRefused);

  const std::string& name() const { return file_.name(); }  ///< path of the file, for messages
  const ResultHeader& header() const { return header_; }
  const ResultFindings& findings() const { return findings_; }

  /// Number of rows of a table; 0 where the result does not have it.
  template <typename Rows>
  std::uint64_t rows() const {
    return table<Rows>().rows;
  }
  std::uint64_t collisions() const { return rows<Collisions>(); }
  std::uint64_t clearances() const { return rows<Clearances>(); }
  std::uint64_t near() const { return rows<Nearby>(); }
  std::uint64_t profile_rows() const { return rows<ProfileRows>(); }
  /// Hash of the question, the inputs and the answer. Results that differ in any of these have
  /// different ones, whatever engine and device searched.
  std::uint64_t identity() const;
  /// Hash of a table's values; 0 where the result does not have it.
  template <typename Rows>
  std::uint64_t table_hash() const;

  /// Reads `count` rows from row `first` on into `out`, on the threads of the caller's arena.
  /// Columns that the result does not have become empty. order: that of the rows before them, which
  /// takes these in.
  template <typename Rows>
  void read(std::uint64_t first, std::size_t count, Rows& out, OrderOf<Rows>& order) const;
  template <typename Rows>
  void read(std::uint64_t first, std::size_t count, Rows& out) const {
    OrderOf<Rows> order;
    read(first, count, out, order);
  }

  /// Reads a whole table; without rows where the result does not have it.
  template <typename Rows>
  Rows all() const {
    Rows out;
    read(0, rows<Rows>(), out);
    return out;
  }

  /// Reads a whole column of a table, as in column(&Collisions::xyz); no values where the result
  /// does not have it.
  template <typename Rows, typename Value>
  std::vector<Value> column(std::vector<Value> Rows::*values) const;

 private:
  template <typename Value>
  using Stored = std::optional<StoredValues<Value>>;

  template <typename Rows>
  struct StoredTable {
    PerColumn<Rows, Stored> columns = {};
    std::uint64_t rows = 0;
  };

  template <typename Rows>
  const StoredTable<Rows>& table() const {
    return std::get<StoredTable<Rows>>(tables_);
  }
  template <typename Rows>
  void open(StoredTable<Rows>& table) const;
  template <typename Rows, typename Value>
  void read_column(const Column<Rows, Value>& column, const StoredValues<Value>& stored,
                   std::uint64_t first, std::vector<Value>& out) const;

  TableFile file_;
  ResultHeader header_;
  ResultFindings findings_;
  std::tuple<StoredTable<Collisions>, StoredTable<Clearances>, StoredTable<ProfileRows>,
             StoredTable<Nearby>, StoredTable<UnseenCubes>, StoredTable<SweptCells>>
      tables_;
};

/// Number of rows that a stream reads at a time by default. Their chunks are enough work for the
/// threads of one machine.
inline constexpr std::size_t kBatchRows = 4 * kPieceRows;

/// Reads a table of a result front to back in constant memory, batch_rows at a time. A result
/// without the table has no rows. The reader must outlive the stream.
template <typename Rows>
class RowStream {
 public:
  explicit RowStream(const ResultReader& reader, std::size_t batch_rows = kBatchRows)
      : reader_(&reader), batch_rows_(batch_rows) {}

  /// Fills `rows` with the next rows. Returns false, with no rows, at the end. Throws InputError as
  /// ResultReader does, and for rows out of order from one batch to the next.
  bool read(Rows& rows) {
    const auto count = std::min<std::uint64_t>(batch_rows_, reader_->rows<Rows>() - next_);
    reader_->read(next_, count, rows, order_);
    next_ += count;
    return count > 0;
  }

 private:
  const ResultReader* reader_;
  std::size_t batch_rows_;
  std::uint64_t next_ = 0;
  OrderOf<Rows> order_;
};

/// Steps through the rows of a table that has sources. The reader must outlive the cursor. Throws
/// as RowStream does; only at_end() may be called at the end.
template <typename Rows>
class RowCursor {
 public:
  explicit RowCursor(const ResultReader& reader, std::size_t batch_rows = kBatchRows)
      : stream_(reader, batch_rows) {
    stream_.read(rows_);
  }

  bool at_end() const { return rows_.size() == 0; }
  std::uint64_t source() const { return rows_.source[at_]; }
  /// The value of a column that the result has, as in row.get(&Collisions::xyz).
  template <typename Value>
  const Value& get(std::vector<Value> Rows::*values) const {
    return (rows_.*values)[at_];
  }
  /// The value of a column, or nullopt where the result does not have it.
  template <typename Value>
  std::optional<Value> find(std::vector<Value> Rows::*values) const {
    return (rows_.*values).empty() ? std::nullopt : std::optional((rows_.*values)[at_]);
  }
  /// The rows around the cursor, and the index of its own row among them.
  const Rows& rows() const { return rows_; }
  std::size_t index() const { return at_; }
  void advance() {
    if (++at_ < rows_.size()) return;
    at_ = 0;
    stream_.read(rows_);
  }

 private:
  RowStream<Rows> stream_;
  Rows rows_;
  std::size_t at_ = 0;
};

using CollisionCursor = RowCursor<Collisions>;
using ClearanceCursor = RowCursor<Clearances>;

/// Advances two cursors together to their ends. For each source index it calls only_in_a, only_in_b
/// or in_both, before the cursors move on.
template <typename Cursor, typename OnlyA, typename OnlyB, typename Both>
void merge_rows(Cursor& a, Cursor& b, OnlyA only_in_a, OnlyB only_in_b, Both in_both) {
  while (!a.at_end() || !b.at_end()) {
    if (b.at_end() || (!a.at_end() && a.source() < b.source())) {
      only_in_a();
      a.advance();
    } else if (a.at_end() || b.source() < a.source()) {
      only_in_b();
      b.advance();
    } else {
      in_both();
      a.advance();
      b.advance();
    }
  }
}

}  // namespace clearway
