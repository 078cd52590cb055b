#pragma once

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/util/progress.hpp"
#include "core/util/tsan_annotations.hpp"
#include "stream/write/order_rows.hpp"
#include "stream/write/set_cells.hpp"
#include "stream/write/source_parts.hpp"

namespace clearway {

/// Brings the entries of a set into the order of their source indices, for some parts of these at a
/// time. Row: what is kept of an entry, with its `source`. All functions throw InputError for a
/// damaged cell and Interrupted when the progress asks to stop.
template <typename Row, typename Set>
class GatherRows {
 public:
  GatherRows(const StoreReader& store, const Set& set, const SetCells& in, Progress& progress)
      : store_(store),
        set_(set),
        in_(in),
        progress_(progress),
        parts_(store),
        counts_(parts_.count()),
        threads_([this] { return CellRows(parts_); }) {
    for_each_cell(0, parts_.count(), [this](std::uint32_t, const CellRows& cell) {
      for (const std::size_t part : cell.parts()) {
        std::atomic_ref(counts_[part]).fetch_add(cell.rows_of(part), std::memory_order_relaxed);
      }
    });
  }

  /// Number of rows in each part.
  const std::vector<std::uint64_t>& counts() const { return counts_; }

  /// Fills `rows` with the rows of parts `first` to `end` - 1, in order. rows_of(cell): returns the
  /// function that makes a row of (source, entry, index in the cell). rows: must have the length
  /// that counts() gives. without_copy: see PartOrder.
  template <typename RowsOf>
  void gather(std::size_t first, std::size_t end, std::span<Row> rows, bool without_copy,
              RowsOf rows_of) {
    threads_.clear();                              // other threads than before may take part
    std::vector<std::uint64_t> next(end - first);  // next free place of each part
    for (std::size_t part = first, at = 0; part < end; at += counts_[part++]) {
      next[part - first] = at;
    }
    scatter(first, end, next, rows, rows_of);
    order(first, end, next, rows, without_copy);
  }

 private:
  using Range = tbb::blocked_range<std::size_t>;

  /// Calls visit(cell, rows) for each cell that has rows in parts `first` to `end` - 1. Takes a
  /// std::function, because the thread sanitizer cannot handle types with names of thousands of
  /// letters.
  void for_each_cell(std::size_t first, std::size_t end,
                     const std::function<void(std::uint32_t, const CellRows&)>& visit) {
    const ParallelScope scope;
    const auto cells = piece_of(scope, [&](const Range& range) {
      CellRows& rows = threads_.local();
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        throw_if_stopped(progress_);
        rows.take(store_, set_, in_.cells[i], first, end);
        if (!rows.rows().empty()) visit(in_.cells[i], rows);
      }
    });
    scope.begin();
    tbb::parallel_for(Range(0, in_.cells.size()), cells);
  }

  template <typename RowsOf>
  void scatter(std::size_t first, std::size_t end, std::vector<std::uint64_t>& next,
               std::span<Row> rows, RowsOf rows_of) {
    tbb::enumerable_thread_specific<std::vector<std::uint64_t>> places(end - first);
    for_each_cell(first, end, [&](std::uint32_t cell, const CellRows& found) {
      std::vector<std::uint64_t>& place = places.local();
      for (const std::size_t part : found.parts()) {
        place[part - first] = std::atomic_ref(next[part - first])
                                  .fetch_add(found.rows_of(part), std::memory_order_relaxed);
      }
      const auto row_of = rows_of(cell);
      const std::uint64_t entries = std::uint64_t{cell} * store_.cell_entries();
      for (const CellRows::Row& row : found.rows()) {
        rows[place[SourceParts::of(row.source) - first]++] =
            row_of(row.source, row.entry, static_cast<std::uint32_t>(row.entry - entries));
      }
    });
  }

  /// Orders the rows of each part. ends: ends of the parts in `rows`.
  void order(std::size_t first, std::size_t end, const std::vector<std::uint64_t>& ends,
             std::span<Row> rows, bool without_copy) {
    tbb::enumerable_thread_specific<PartOrder<Row>> orders(without_copy);
    const ParallelScope scope;
    const auto parts = piece_of(scope, [&](const Range& range) {
      PartOrder<Row>& order = orders.local();
      for (std::size_t part = range.begin(); part != range.end(); ++part) {
        throw_if_stopped(progress_);
        order.order(rows.subspan(ends[part - first] - counts_[part], counts_[part]));
      }
    });
    scope.begin();
    tbb::parallel_for(Range(first, end), parts);
  }

  const StoreReader& store_;
  const Set& set_;
  const SetCells& in_;
  Progress& progress_;
  const SourceParts parts_;
  std::vector<std::uint64_t> counts_;
  tbb::enumerable_thread_specific<CellRows> threads_;
};

}  // namespace clearway
