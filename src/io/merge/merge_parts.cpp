#include "io/merge/merge_parts.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <queue>
#include <string>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "io/merge/part_set.hpp"
#include "io/result/answer.hpp"
#include "io/result/result.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

/// Bytes of the program and of what the writer holds back.
constexpr std::uint64_t kFixedBytes = std::uint64_t{32} << 20;
/// Bytes of an open file: its metadata in HDF5.
constexpr std::uint64_t kFileBytes = std::uint64_t{512} << 10;
/// Most bytes of a dataset's chunks that HDF5 caches.
constexpr std::uint64_t kCacheBytes = std::uint64_t{1} << 20;

constexpr std::size_t kLeastRows = 1 << 10;

/// Bytes of the values of a row, with all columns.
template <typename Rows>
std::uint64_t row_bytes() {
  std::uint64_t bytes = 0;
  for_each_column<Rows>(
      [&](const auto& column) { bytes += sizeof(typename std::decay_t<decltype(column)>::Value); });
  return bytes;
}

/// Most bytes of chunks that HDF5 caches for a table.
template <typename Rows>
std::uint64_t cached_bytes(const ResultReader& part) {
  std::uint64_t bytes = 0;
  for_each_column<Rows>([&](const auto& column) {
    if (!column.is_in(part.header())) return;
    using Value = typename std::decay_t<decltype(column)>::Value;
    bytes += std::min(kCacheBytes, part.rows<Rows>() * sizeof(Value));
  });
  return bytes;
}

std::uint64_t needed_bytes(const PartSet& set, std::size_t batch_rows) {
  std::uint64_t bytes = kFixedBytes + 4 * batch_rows * row_bytes<ProfileRows>();
  const std::uint64_t point_bytes = std::max(row_bytes<Collisions>(), row_bytes<Clearances>());
  for (const ResultReader& part : set.parts()) {
    const std::uint64_t rows = std::max(part.collisions(), part.clearances());
    bytes += kFileBytes + cached_bytes<Collisions>(part) + cached_bytes<Clearances>(part) +
             cached_bytes<ProfileRows>(part) +
             std::min<std::uint64_t>(batch_rows, rows) * point_bytes;
  }
  return bytes;
}

/// Number of rows of each part that merging holds at once, a power of two, chosen so that it takes
/// at most `memory_bytes`. Throws ResourceError where even the fewest rows are too many.
std::size_t batch_rows_of(const PartSet& set, std::uint64_t memory_bytes) {
  for (std::size_t rows = kBatchRows; rows >= kLeastRows; rows /= 2) {
    if (needed_bytes(set, rows) <= memory_bytes) return rows;
  }
  const std::uint64_t needed = needed_bytes(set, kLeastRows);
  throw ResourceError(format_size(memory_bytes) + " of memory is too little: to merge " +
                          std::to_string(set.parts().size()) + " parts needs " +
                          format_size(needed),
                      Remedy::kMoreMemory, static_cast<double>(needed));
}

/// Number of rows that are given to the writer at once.
constexpr std::size_t kRows = 1 << 12;

/// Calls visit(cursor) for every row of all cursors, ascending by source.
template <typename Cursor, typename Visit>
void for_each_row(const PartSet& set, std::deque<Cursor>& cursors, Visit visit) {
  using Head = std::pair<std::uint64_t, std::size_t>;  // source and part
  std::priority_queue<Head, std::vector<Head>, std::greater<>> heads;
  for (std::size_t part = 0; part < cursors.size(); ++part) {
    if (!cursors[part].at_end()) heads.emplace(cursors[part].source(), part);
  }
  while (!heads.empty()) {
    const auto [source, part] = heads.top();
    heads.pop();
    if (!heads.empty() && heads.top().first == source) {
      refuse(set.parts()[heads.top().second].name(), "has source point " + std::to_string(source) +
                                                         ", as " + set.parts()[part].name() +
                                                         " has; they are no parts of one result");
    }
    const std::uint64_t next =
        heads.empty() ? std::numeric_limits<std::uint64_t>::max() : heads.top().first;
    Cursor& cursor = cursors[part];
    do {
      visit(cursor);
      cursor.advance();
    } while (!cursor.at_end() && cursor.source() < next);
    if (!cursor.at_end()) heads.emplace(cursor.source(), part);
  }
}

class PartMerge {
 public:
  PartMerge(const PartSet& set, const std::filesystem::path& path, std::size_t batch_rows,
            Progress& progress, TableSummary& summary)
      : set_(set),
        batch_rows_(batch_rows),
        progress_(progress),
        summary_(summary),
        writer_(path, set.header(), set.collisions(), set.clearances()) {}

  void run() {
    summary_ = {};
    progress_.begin("merge", set_.collisions() + set_.clearances(), "points");
    merge_points<Collisions>();
    if (Table<Clearances>::is_in(set_.header())) merge_points<Clearances>();
    if (Table<ProfileRows>::is_in(set_.header())) merge_profile();
    writer_.finish(set_.findings());
    progress_.end();
  }

 private:
  /// Merges a table of points, of which each is in one part.
  template <typename Rows>
  void merge_points() {
    std::deque<RowCursor<Rows>> cursors;
    for (const ResultReader& part : set_.parts()) cursors.emplace_back(part, batch_rows_);
    Rows rows;
    const auto flush = [&] {
      throw_if_stopped(progress_);
      writer_.append(rows);
      summarise(rows, summary_);
      progress_.advance(rows.size());
      clear_rows(rows);
    };
    for_each_row(set_, cursors, [&](const RowCursor<Rows>& row) {
      append_row(set_.header(), row.rows(), row.index(), rows);
      if (rows.size() == kRows) flush();
    });
    flush();
  }

  /// Merges the profiles: for each pose the part with the least squared distance, and of several
  /// the one with the smallest source.
  void merge_profile() {
    std::deque<RowStream<ProfileRows>> streams;
    for (const ResultReader& part : set_.parts()) streams.emplace_back(part, batch_rows_);
    std::uint64_t first = 0;
    for (ProfileRows best, rows; streams.front().read(best); first += best.size()) {
      for (std::size_t part = 1; part < streams.size(); ++part) {
        streams[part].read(rows);
        if (rows.chainage != best.chainage) {
          refuse(set_.parts()[part].name(),
                 "/profile/chainage differs from that of " + set_.parts().front().name());
        }
        keep_nearer(rows, best);
      }
      best.squared.clear();  // only parts have them
      writer_.append(best);
      summarise(best, summary_, first);
      throw_if_stopped(progress_);
    }
    // Reads the other streams to their ends, where their hashes are checked.
    for (std::size_t part = 1; part < streams.size(); ++part) {
      ProfileRows none;
      streams[part].read(none);
    }
  }

  static void keep_nearer(const ProfileRows& rows, ProfileRows& best) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const bool nearer = rows.squared[i] < best.squared[i] ||
                          (rows.squared[i] == best.squared[i] && rows.source[i] < best.source[i]);
      if (!nearer) continue;
      for_each_column<ProfileRows>(
          [&](const auto& column) { (best.*column.values)[i] = (rows.*column.values)[i]; });
    }
  }

  const PartSet& set_;
  const std::size_t batch_rows_;
  Progress& progress_;
  TableSummary& summary_;
  ResultWriter writer_;
};

}  // namespace

void merge_parts(const PartSet& set, const std::filesystem::path& path, std::uint64_t memory_bytes,
                 Progress& progress, TableSummary& summary) {
  PartMerge(set, path, batch_rows_of(set, memory_bytes), progress, summary).run();
}

}  // namespace clearway
