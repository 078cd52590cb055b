#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "clearway/error.hpp"
#include "io/result/encoded_rows.hpp"
#include "io/result/result_header.hpp"
#include "io/result/tables.hpp"

namespace clearway {

/// Writes the datasets that docs/design/result-format.md lists and the header asks for to a file of
/// its own, which the caller publishes. Its bytes depend on header and rows alone. Collisions come
/// first, then clearances, then the profile, then near points, then unseen cubes, then
/// swept cells. append() and write() throw std::logic_error for rows out of this order, for a table
/// that the header does not ask for, for more rows than promised, for sources that do not ascend
/// (except in the profile) and for columns of unequal lengths, where a column that the header does
/// not ask for must be empty. A failing disk throws ResourceError.
///
/// Instead of appending rows, threads may encode them kEncodedRows at a time; only the last rows of
/// a table may be fewer. The encoded rows are then hashed in order and written in order. One thread
/// at a time may hash and one at a time may write; the two may differ.
///
/// `Rows` is Collisions, Clearances, ProfileRows, Nearby, UnseenCubes or SweptCells.
class ResultWriter {
 public:
  /// Creates the file at `path`. collisions, clearances, near, unseen, swept: number of rows that
  /// will be written.
  /// The profile has one row per pose.
  ResultWriter(const std::filesystem::path& path, const ResultHeader& header,
               std::uint64_t collisions, std::uint64_t clearances = 0, std::uint64_t near = 0,
               std::uint64_t unseen = 0, std::uint64_t swept = 0);
  ~ResultWriter();

  /// Appends any number of rows.
  template <typename Rows>
  void append(const Rows& rows);

  /// Empty rows for the caller to fill and seal. Thread safe.
  template <typename Rows>
  EncodedRows<Rows> new_rows() const;
  template <typename Rows>
  void hash(const EncodedRows<Rows>& rows);
  template <typename Rows>
  void write(EncodedRows<Rows>& rows);

  /// Writes the findings and closes the file. Throws std::logic_error unless as many rows as
  /// promised were appended.
  void finish(const ResultFindings& findings = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Whether ResultReader accepts a part of a result in place of a whole one.
enum class Parts { kRefused, kAccepted };

/// Reads a result. No value leaves it that was not checked against the hash of its column: whole
/// tables and columns are checked before they are returned, and RowStream checks at its end. Throws
/// InputError when the file is not a complete result, is damaged, or holds rows that no run can
/// have found: source indices of points are strictly ascending and below
/// header().environment_points, poses are below header().poses, bodies below their number, and
/// distances at most what was asked for and below 0 only for models with solids.
///
/// `Rows` is Collisions, Clearances, ProfileRows, Nearby, UnseenCubes or SweptCells.
class ResultReader {
 public:
  explicit ResultReader(const std::filesystem::path& path, Parts parts = Parts::kRefused);
  ~ResultReader();
  ResultReader(ResultReader&&) noexcept;
  ResultReader& operator=(ResultReader&&) noexcept;

  const std::string& name() const;  ///< path of the file, for messages
  const ResultHeader& header() const;
  const ResultFindings& findings() const;

  /// Number of rows of a table; 0 where the result does not have it.
  template <typename Rows>
  std::uint64_t rows() const;
  std::uint64_t collisions() const { return rows<Collisions>(); }
  std::uint64_t clearances() const { return rows<Clearances>(); }
  std::uint64_t near() const { return rows<Nearby>(); }
  std::uint64_t profile_rows() const { return rows<ProfileRows>(); }
  /// Hash of the question, the inputs and the answer. Results that differ in any of these have
  /// different ones, whatever engine and device searched.
  std::uint64_t identity() const;
  /// The hash of the recorded hashes of a table's columns; 0 where the result does not have it.
  template <typename Rows>
  std::uint64_t recorded_hash() const;

  /// Reads `count` rows from row `first` on into `out`, and adds their values to `hashes`, which
  /// the caller has to check after the last row. Columns that the result does not have become
  /// empty. Uses many threads where `first` is a multiple of kEncodedRows and the number of rows is
  /// one too, or reaches the end of the table.
  template <typename Rows>
  void read(std::uint64_t first, std::size_t count, Rows& out, RowHashes<Rows>& hashes) const;
  /// Throws InputError unless these are the hashes of all rows of the table.
  template <typename Rows>
  void check_hashes(const RowHashes<Rows>& hashes) const;

  /// Reads a whole table; without rows where the result does not have it.
  template <typename Rows>
  Rows all() const {
    Rows out;
    RowHashes<Rows> hashes;
    read(0, rows<Rows>(), out, hashes);
    check_hashes<Rows>(hashes);
    return out;
  }

  /// Reads a whole column of a table, as in column(&Collisions::xyz); no values where the result
  /// does not have it.
  template <typename Rows, typename Value>
  std::vector<Value> column(std::vector<Value> Rows::*values) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Number of rows that a stream reads at a time by default, a multiple of kEncodedRows. Their
/// chunks are enough work for the threads of one machine.
inline constexpr std::size_t kBatchRows = 4 * kEncodedRows;

/// Reads a table of a result front to back in constant memory, batch_rows at a time; a multiple of
/// kEncodedRows is read by many threads, another number by one. A result without the table has no
/// rows. The reader must outlive the stream.
template <typename Rows>
class RowStream {
 public:
  explicit RowStream(const ResultReader& reader, std::size_t batch_rows = kBatchRows)
      : reader_(&reader), batch_rows_(batch_rows) {}

  /// Fills `rows` with the next rows. Returns false, with no rows, at the end. Throws InputError as
  /// ResultReader does, for rows out of order from one batch to the next, and at the end for rows
  /// that do not have the recorded hash.
  bool read(Rows& rows) {
    const std::uint64_t first = next_;
    const auto count = std::min<std::uint64_t>(batch_rows_, reader_->rows<Rows>() - first);
    if (count == 0) {
      clear_rows(rows);
      reader_->check_hashes<Rows>(hashes_);
      return false;
    }
    reader_->read(first, count, rows, hashes_);
    const auto& order = rows.*Table<Rows>::kOrder;
    if (last_ && !Table<Rows>::may_follow(*last_, order.front())) {
      RowsRead{reader_->name(), reader_->header(), Table<Rows>::kGroup, first}.refuse_row(
          Table<Rows>::kOrderDataset, 0, Table<Rows>::kExpectedOrder);
    }
    last_ = order.back();
    next_ += count;
    return true;
  }

 private:
  const ResultReader* reader_;
  std::size_t batch_rows_;
  std::uint64_t next_ = 0;
  std::optional<
      typename std::decay_t<decltype(std::declval<Rows>().*Table<Rows>::kOrder)>::value_type>
      last_;
  RowHashes<Rows> hashes_;
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
