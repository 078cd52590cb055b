#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/cloud/packed_cloud.hpp"
#include "core/util/progress.hpp"
#include "io/files/input_error.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/store/store_reader.hpp"
#include "stream/answer_rows.hpp"

namespace clearway {

/// The source indices in parts of 2^16. Because no two points have the same one, a part has at most
/// that many rows.
class SourceParts {
 public:
  static constexpr unsigned kBits = 16;
  static constexpr std::uint64_t kMostRows = std::uint64_t{1} << kBits;

  explicit SourceParts(std::uint64_t sources) : parts_((sources + kMostRows - 1) >> kBits) {}
  explicit SourceParts(const StoreReader& store) : SourceParts(store.metadata().input_points) {}

  std::size_t count() const { return parts_; }
  static std::size_t of(std::uint64_t source) { return source >> kBits; }

 private:
  std::size_t parts_;
};

/// One thread's count of a cell's rows by the part of their source indices.
class CellParts {
 public:
  explicit CellParts(const SourceParts& parts) : counts_(parts.count()) {}

  /// Memory of each thread, bytes.
  static std::uint64_t most_bytes(const StoreReader& store) {
    return SourceParts(store).count() * (sizeof(std::uint32_t) + sizeof(std::size_t));
  }

  /// Counts the rows of a cell whose parts are `first_part` to `end_part` - 1, and forgets those of
  /// the cell before. Throws InputError for a damaged cell.
  void count(const StoreReader& store, const AnswerRows& answer, PointQuestion question,
             std::uint32_t cell, std::size_t first_part, std::size_t end_part) {
    for (const std::size_t part : parts_) counts_[part] = 0;
    parts_.clear();
    sources_ = store.sources(cell);
    if (SourceParts::of(sources_.minimum()) >= end_part && end_part < counts_.size()) return;
    rows_ = answer.read(cell, question);
    rows_.for_each([&](std::uint32_t point, std::size_t) {
      const std::size_t part = SourceParts::of(sources_[point]);
      if (part < first_part || part >= end_part) {
        if (part >= counts_.size()) refuse_source(store, cell, sources_[point]);
        return;
      }
      if (counts_[part]++ == 0) parts_.push_back(part);
    });
  }

  /// The rows of the cell that was counted last, and its source indices.
  const CellRows& rows() const { return rows_; }
  const PackedChunk<std::uint64_t>& sources() const { return sources_; }

  /// The parts that have rows, in no particular order.
  const std::vector<std::size_t>& parts() const { return parts_; }
  std::uint32_t rows_of(std::size_t part) const { return counts_[part]; }

 private:
  [[noreturn]] static void refuse_source(const StoreReader& store, std::uint32_t cell,
                                         std::uint64_t source) {
    refuse(store.name(), "cell " + std::to_string(cell) + ": source index " +
                             std::to_string(source) + ", expected one below " +
                             std::to_string(store.metadata().input_points));
  }

  std::vector<std::uint32_t> counts_;
  std::vector<std::size_t> parts_;
  CellRows rows_;
  PackedChunk<std::uint64_t> sources_;
};

/// The ranks of the rows of one part: for each, how many have a smaller source index.
class SourceRanks {
 public:
  /// Fewer rows are sorted faster than all words of the part's bits are visited.
  static constexpr std::size_t kFewest = 256;

  template <typename Row>
  explicit SourceRanks(std::span<const Row> rows) {
    bits_.fill(0);
    for (const Row& row : rows) bits_[word_of(row.source)] |= bit_of(row.source);
    for (std::size_t word = 0; word < kWords; ++word) {
      before_[word] = count_;
      count_ += static_cast<std::uint32_t>(std::popcount(bits_[word]));
    }
  }

  /// The number of different source indices.
  std::size_t count() const { return count_; }

  std::size_t of(std::uint64_t source) const {
    const std::size_t word = word_of(source);
    const std::uint64_t below = bits_[word] & (bit_of(source) - 1);
    return before_[word] + static_cast<std::uint32_t>(std::popcount(below));
  }

 private:
  static constexpr std::size_t kWords = SourceParts::kMostRows / 64;

  static std::size_t word_of(std::uint64_t source) { return source / 64 % kWords; }
  static std::uint64_t bit_of(std::uint64_t source) { return std::uint64_t{1} << (source % 64); }

  std::array<std::uint64_t, kWords> bits_;
  std::array<std::uint32_t, kWords> before_;
  std::uint32_t count_ = 0;
};

/// Orders the rows of one part by source index. copy: memory for as many rows, with which that is
/// several times faster; may be too small.
template <typename Row>
void order_part(std::span<Row> rows, std::span<Row> copy) {
  if (rows.size() >= SourceRanks::kFewest && copy.size() >= rows.size()) {
    const SourceRanks ranks{std::span<const Row>(rows)};
    if (ranks.count() == rows.size()) {
      copy = copy.first(rows.size());
      std::ranges::copy(rows, copy.begin());
      for (const Row& row : copy) rows[ranks.of(row.source)] = row;
      return;
    }
  }
  std::ranges::sort(rows, {}, &Row::source);
}

/// Brings the rows of a question into the order of their source indices, for some parts of these at
/// a time. Row: what is kept of a row, with its `source`. All functions throw InputError for a
/// damaged cell and Interrupted when the progress asks to stop.
template <typename Row>
class GatherRows {
 public:
  GatherRows(const StoreReader& store, const AnswerRows& answer, PointQuestion question,
             Progress& progress)
      : store_(store),
        answer_(answer),
        question_(question),
        cells_(answer.cells(question)),
        progress_(progress),
        parts_(store),
        counts_(parts_.count()),
        threads_([this] { return CellParts(parts_); }) {
    for_each_cell(0, parts_.count(), [this](std::uint32_t, const CellParts& cell) {
      for (const std::size_t part : cell.parts()) {
        std::atomic_ref(counts_[part]).fetch_add(cell.rows_of(part), std::memory_order_relaxed);
      }
    });
  }

  /// Number of rows in each part.
  const std::vector<std::uint64_t>& counts() const { return counts_; }

  /// Fills `rows` with the rows of parts `first` to `end` - 1, in order. rows_of(cell, found):
  /// returns the function that makes a row of (source, index in the cell, index in `found`). rows:
  /// must have the length that counts() gives. copies: memory in which threads copy a part each, as
  /// far as there is room.
  template <typename RowsOf>
  void gather(std::size_t first, std::size_t end, std::span<Row> rows, std::span<Row> copies,
              RowsOf rows_of) {
    threads_.clear();  // other threads than before may take part
    std::vector<Places> parts(end - first);
    for (std::size_t part = first, at = 0; part < end; ++part) {
      parts[part - first] = {at, at + counts_[part]};
      at += counts_[part];
    }
    scatter(first, end, parts, rows, rows_of);
    order(first, end, parts, rows, copies);
  }

 private:
  using Range = tbb::blocked_range<std::size_t>;

  /// The places that are left for rows: of a part, or of the rows of one cell in it. No row is put
  /// elsewhere, whatever happens to the file while it is read.
  struct Places {
    std::uint64_t next = 0, end = 0;
  };

  [[noreturn]] void refuse_change() const {
    refuse(store_.name(), "its points changed while they were read");
  }

  /// Calls visit(cell, its parts) for each cell that has rows in parts `first` to `end` - 1. Takes
  /// a std::function, because the thread sanitizer cannot handle types with names of thousands of
  /// letters.
  void for_each_cell(std::size_t first, std::size_t end,
                     const std::function<void(std::uint32_t, const CellParts&)>& visit) {
    for_each_parallel(Range(0, cells_.size()), [&](const Range& range) {
      CellParts& parts = threads_.local();
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        throw_if_stopped(progress_);
        parts.count(store_, answer_, question_, cells_[i], first, end);
        if (!parts.parts().empty()) visit(cells_[i], parts);
      }
    });
  }

  /// Puts the rows of each part into its places, in any order.
  template <typename RowsOf>
  void scatter(std::size_t first, std::size_t end, std::vector<Places>& parts, std::span<Row> rows,
               RowsOf rows_of) {
    tbb::enumerable_thread_specific<std::vector<Places>> of_cell(end - first);
    for_each_cell(first, end, [&](std::uint32_t cell, const CellParts& found) {
      std::vector<Places>& places = of_cell.local();
      for (const std::size_t part : found.parts()) {
        Places& whole = parts[part - first];
        const std::uint64_t count = found.rows_of(part);
        const std::uint64_t at =
            std::atomic_ref(whole.next).fetch_add(count, std::memory_order_relaxed);
        if (at + count > whole.end) refuse_change();
        places[part - first] = {at, at + count};
      }
      const auto row_of = rows_of(cell, found.rows());
      found.rows().for_each([&](std::uint32_t point, std::size_t row) {
        const std::uint64_t source = found.sources()[point];
        const std::size_t part = SourceParts::of(source);
        if (part < first || part >= end) return;
        Places& here = places[part - first];
        if (here.next == here.end) refuse_change();
        rows[here.next++] = row_of(source, point, row);
      });
    });
    const auto is_full = [](const Places& part) { return part.next == part.end; };
    if (!std::ranges::all_of(parts, is_full)) refuse_change();
  }

  /// Orders the rows of each part.
  void order(std::size_t first, std::size_t end, const std::vector<Places>& places,
             std::span<Row> rows, std::span<Row> copies) {
    const std::size_t largest =
        *std::max_element(counts_.begin() + static_cast<std::ptrdiff_t>(first),
                          counts_.begin() + static_cast<std::ptrdiff_t>(end));
    std::atomic<std::size_t> taken = 0;
    tbb::enumerable_thread_specific<std::span<Row>> copy_of_thread([&] {
      const std::size_t at = taken.fetch_add(largest);
      return at + largest <= copies.size() ? copies.subspan(at, largest) : std::span<Row>();
    });
    for_each_parallel(Range(first, end), [&](const Range& range) {
      const std::span<Row> copy = copy_of_thread.local();
      for (std::size_t part = range.begin(); part != range.end(); ++part) {
        throw_if_stopped(progress_);
        const std::uint64_t count = counts_[part];
        order_part(rows.subspan(places[part - first].end - count, count), copy);
      }
    });
  }

  const StoreReader& store_;
  const AnswerRows& answer_;
  const PointQuestion question_;
  const std::vector<std::uint32_t> cells_;
  Progress& progress_;
  const SourceParts parts_;
  std::vector<std::uint64_t> counts_;
  tbb::enumerable_thread_specific<CellParts> threads_;
};

}  // namespace clearway
