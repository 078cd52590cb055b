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
#include "clearway/result.hpp"
#include "core/util/format.hpp"
#include "io/merge/part_set.hpp"
#include "io/result/result_cursor.hpp"
#include "io/result/result_rows.hpp"
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

/// Bytes of a row in the widest table of points, and of a row of the profile.
constexpr std::uint64_t kPointBytes = 48, kPoseBytes = 56;

std::uint64_t cached_bytes(std::uint64_t rows, std::initializer_list<std::uint64_t> value_bytes) {
  std::uint64_t bytes = 0;
  for (const std::uint64_t one : value_bytes) bytes += std::min(kCacheBytes, rows * one);
  return bytes;
}

std::uint64_t needed_bytes(const PartSet& set, std::size_t batch_rows) {
  std::uint64_t bytes = kFixedBytes + 4 * batch_rows * kPoseBytes;
  for (const ResultReader& part : set.parts()) {
    const std::uint64_t rows = std::max(part.collisions(), part.clearances());
    bytes += kFileBytes + cached_bytes(part.collisions(), {8, 24, 4, 4}) +
             cached_bytes(part.clearances(), {8, 24, 8, 4}) +
             cached_bytes(part.profile_rows(), {8, 8, 24, 8, 8}) +
             std::min<std::uint64_t>(batch_rows, rows) * kPointBytes;
  }
  return bytes;
}

/// Number of rows of each part that merging holds at once, a power of two, chosen so that it takes
/// at most `memory_bytes`. Throws ResourceError where even the fewest rows are too many.
std::size_t batch_rows_of(const PartSet& set, std::uint64_t memory_bytes) {
  for (std::size_t rows = ResultRowStream::kBatchRows; rows >= kLeastRows; rows /= 2) {
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
            Progress& progress, Answer& answer)
      : set_(set),
        batch_rows_(batch_rows),
        progress_(progress),
        out_(answer),
        writer_(path, set.header(), set.collisions(), set.clearances()) {}

  void run() {
    progress_.begin("merge", set_.collisions() + set_.clearances(), "points");
    merge_collisions();
    if (set_.header().clearance > 0) merge_clearances();
    if (set_.header().profile > 0) merge_profile();
    writer_.finish(set_.findings());
    progress_.end();
  }

 private:
  template <typename Cursor>
  std::deque<Cursor> cursors() const {
    std::deque<Cursor> all;
    for (const ResultReader& part : set_.parts()) all.emplace_back(part, batch_rows_);
    return all;
  }

  void merge_collisions() {
    auto all = cursors<RowCursor>();
    ResultRows rows;
    const auto flush = [&] {
      writer_.append(rows.source, rows.xyz, rows.first_pose, rows.body, rows.last_pose);
      written(rows);
      rows.first_pose.clear();
      rows.last_pose.clear();
    };
    for_each_row(set_, all, [&](const RowCursor& row) {
      rows.source.push_back(row.source());
      rows.xyz.push_back(row.xyz());
      if (const auto pose = row.first_pose()) {
        rows.first_pose.push_back(*pose);
        if (!out_.first_place || *pose < out_.first_place->pose) {
          out_.first_place = {row.source(), *pose, row.xyz(), 0, row.body().value_or(0)};
        }
      }
      if (const auto body = row.body()) rows.body.push_back(*body);
      if (set_.header().last_pose) rows.last_pose.push_back(*row.last_pose());
      if (rows.size() == kRows) flush();
    });
    flush();
  }

  void merge_clearances() {
    auto all = cursors<ClearanceCursor>();
    ClearanceRows rows;
    const auto flush = [&] {
      writer_.append_clearances(rows.source, rows.xyz, rows.distance, rows.pose, rows.body);
      written(rows);
      rows.distance.clear();
      rows.pose.clear();
    };
    for_each_row(set_, all, [&](const ClearanceCursor& row) {
      rows.source.push_back(row.source());
      rows.xyz.push_back(row.xyz());
      rows.distance.push_back(row.distance());
      rows.pose.push_back(row.pose());
      if (row.distance() < 0) ++out_.inside_points;
      if (!out_.least_clearance || row.distance() < out_.least_clearance->distance) {
        out_.least_clearance = {row.source(), row.pose(), row.xyz(), row.distance(),
                                row.body().value_or(0)};
      }
      if (const auto body = row.body()) rows.body.push_back(*body);
      if (rows.size() == kRows) flush();
    });
    flush();
  }

  template <typename Rows>
  void written(Rows& rows) {
    throw_if_stopped(progress_);
    progress_.advance(rows.size());
    rows.source.clear();
    rows.xyz.clear();
    rows.body.clear();
  }

  /// Merges the profiles: for each pose the part with the least squared distance, and of several
  /// the one with the smallest source.
  void merge_profile() {
    std::deque<ProfileRowStream> streams;
    for (const ResultReader& part : set_.parts()) streams.emplace_back(part, batch_rows_);
    std::uint32_t first = 0;
    for (ProfileRows best, rows; streams.front().read(best);) {
      for (std::size_t part = 1; part < streams.size(); ++part) {
        streams[part].read(rows);
        if (rows.chainage != best.chainage) {
          refuse(set_.parts()[part].name(),
                 "/profile/chainage differs from that of " + set_.parts().front().name());
        }
        keep_nearer(rows, best);
      }
      writer_.append_profile(best.distance, best.source, best.xyz, best.chainage);
      keep_least(best, first);
      first += static_cast<std::uint32_t>(best.size());
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
      best.distance[i] = rows.distance[i];
      best.source[i] = rows.source[i];
      best.xyz[i] = rows.xyz[i];
      best.squared[i] = rows.squared[i];
    }
  }

  void keep_least(const ProfileRows& rows, std::uint32_t first) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows.source[i] == Profile::kNoPoint) continue;
      ++out_.profile_poses;
      if (out_.least_profile && out_.least_profile->distance <= rows.distance[i]) continue;
      out_.least_profile = {rows.source[i], first + static_cast<std::uint32_t>(i), rows.xyz[i],
                            rows.distance[i]};
    }
  }

  const PartSet& set_;
  const std::size_t batch_rows_;
  Progress& progress_;
  Answer& out_;
  ResultWriter writer_;
};

}  // namespace

void merge_parts(const PartSet& set, const std::filesystem::path& path, std::uint64_t memory_bytes,
                 Progress& progress, Answer& answer) {
  PartMerge(set, path, batch_rows_of(set, memory_bytes), progress, answer).run();
}

}  // namespace clearway
