#include "stream/write_result.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "core/cloud/kd_order.hpp"
#include "stream/write_profile.hpp"

namespace clearway {
namespace {

struct Collision {
  std::uint64_t source;
  std::int32_t q[3];
  std::uint32_t first_pose;
};

struct ClearanceRow {
  std::uint64_t source;
  double distance;
  std::int32_t q[3];
  std::uint32_t pose;
};

/// Sorted and written in pieces of this many rows.
constexpr std::size_t kRows = 1 << 16;

/// What the file's writer and the pieces take at the most, bytes.
constexpr std::uint64_t kBufferBytes = std::uint64_t{16} << 20;

/// A pass holds twice the rows that it gives.
template <typename Row>
std::size_t rows_of_pass(std::uint64_t memory_bytes) {
  const std::uint64_t left = memory_bytes > kBufferBytes ? memory_bytes - kBufferBytes : 0;
  return std::max<std::uint64_t>(kRows, left / (2 * sizeof(Row)));
}

/// Calls visit(entry, index in the cell) for every entry of a cell that is in the set.
template <typename Set, typename Visit>
void for_each_entry(const StoreReader& store, const Set& set, std::uint32_t cell, Visit visit) {
  const std::uint64_t first_word = std::uint64_t{cell} * store.blocks_per_cell();
  const auto blocks =
      static_cast<std::uint32_t>(divide_up(store.cells()[cell].count, kBlockPoints));
  for (std::uint32_t block = 0; block < blocks; ++block) {
    for (std::uint64_t bits = set.word(first_word + block); bits != 0; bits &= bits - 1) {
      const auto bit = static_cast<std::uint32_t>(std::countr_zero(bits));
      visit((first_word + block) * kBlockPoints + bit, block * kBlockPoints + bit);
    }
  }
}

template <typename Set>
bool has_entries(const StoreReader& store, const Set& set, std::uint32_t cell) {
  const std::uint64_t first = std::uint64_t{cell} * store.blocks_per_cell();
  for (std::uint64_t word = first; word < first + store.blocks_per_cell(); ++word) {
    if (set.word(word) != 0) return true;
  }
  return false;
}

/// The rows with the smallest source indices >= `from`, at most `most` of them, sorted.
template <typename Row>
class RangePass {
 public:
  /// No more than `count` rows are left.
  RangePass(std::uint64_t from, std::size_t most, std::uint64_t count) : from_(from), most_(most) {
    rows_.reserve(std::min<std::uint64_t>(2 * most, count));
  }

  /// rows_of(cell) gives what makes a row of (source, entry, index in the cell).
  template <typename Set, typename RowsOf>
  void add_cell(const StoreReader& store, const Set& set, std::uint32_t cell, RowsOf rows_of) {
    const PackedChunk<std::uint64_t> sources = store.sources(cell);
    if (sources.minimum() >= below_) return;
    const auto row_of = rows_of(cell);
    for_each_entry(store, set, cell, [&](std::uint64_t entry, std::uint32_t i) {
      const std::uint64_t source = sources[i];
      if (source < from_ || source >= below_) return;
      rows_.push_back(row_of(source, entry, i));
      if (rows_.size() >= 2 * most_) keep_smallest();
    });
  }

  std::vector<Row> take() {
    if (rows_.size() > most_) keep_smallest();
    std::sort(rows_.begin(), rows_.end(), by_source);
    return std::move(rows_);
  }

 private:
  static bool by_source(const Row& a, const Row& b) { return a.source < b.source; }

  void keep_smallest() {
    const auto end = rows_.begin() + static_cast<std::ptrdiff_t>(most_);
    std::nth_element(rows_.begin(), end, rows_.end(), by_source);
    below_ = end->source;
    rows_.erase(end, rows_.end());
  }

  std::uint64_t from_;
  std::uint64_t below_ = std::numeric_limits<std::uint64_t>::max();
  std::size_t most_;
  std::vector<Row> rows_;
};

void append_rows(ResultWriter& writer, const std::vector<Collision>& rows,
                 const Quantisation& quantisation, bool first_pose) {
  std::vector<std::uint64_t> source;
  std::vector<Vec3> xyz;
  std::vector<std::uint32_t> poses;
  const std::size_t most = std::min(kRows, rows.size());
  source.reserve(most);
  xyz.reserve(most);
  if (first_pose) poses.reserve(most);
  for (std::size_t first = 0; first < rows.size(); first += kRows) {
    source.clear();
    xyz.clear();
    poses.clear();
    for (std::size_t i = first; i < std::min(rows.size(), first + kRows); ++i) {
      const Collision& row = rows[i];
      source.push_back(row.source);
      xyz.push_back(position(quantisation, row.q[0], row.q[1], row.q[2]));
      if (first_pose) poses.push_back(row.first_pose);
    }
    writer.append(source, xyz, poses);
  }
}

void append_rows(ResultWriter& writer, const std::vector<ClearanceRow>& rows,
                 const Quantisation& quantisation) {
  std::vector<std::uint64_t> source;
  std::vector<Vec3> xyz;
  std::vector<double> distance;
  std::vector<std::uint32_t> pose;
  const std::size_t most = std::min(kRows, rows.size());
  source.reserve(most);
  xyz.reserve(most);
  distance.reserve(most);
  pose.reserve(most);
  for (std::size_t first = 0; first < rows.size(); first += kRows) {
    source.clear();
    xyz.clear();
    distance.clear();
    pose.clear();
    for (std::size_t i = first; i < std::min(rows.size(), first + kRows); ++i) {
      const ClearanceRow& row = rows[i];
      source.push_back(row.source);
      xyz.push_back(position(quantisation, row.q[0], row.q[1], row.q[2]));
      distance.push_back(row.distance);
      pose.push_back(row.pose);
    }
    writer.append_clearances(source, xyz, distance, pose);
  }
}

/// Writes a set of `count` entries in passes, by append(rows).
template <typename Row, typename Set, typename RowsOf, typename Append>
void write_set(const StoreReader& store, const Set& set, std::uint64_t count,
               std::uint64_t memory_bytes, Progress& progress, RowsOf rows_of, Append append) {
  const std::size_t most = rows_of_pass<Row>(memory_bytes);
  std::vector<std::uint32_t> cells;
  for (std::uint32_t cell = 0; cell < store.cells().size(); ++cell) {
    if (has_entries(store, set, cell)) cells.push_back(cell);
  }
  std::uint64_t from = 0;
  for (std::uint64_t written = 0; written < count;) {
    RangePass<Row> pass(from, most, count - written);
    for (const std::uint32_t cell : cells) {
      throw_if_stopped(progress);
      pass.add_cell(store, set, cell, rows_of);
    }
    const std::vector<Row> rows = pass.take();
    if (rows.empty()) break;  // finish() reports what is missing
    throw_if_stopped(progress);
    append(rows);
    written += rows.size();
    from = rows.back().source + 1;
    progress.advance(rows.size());
  }
}

}  // namespace

void write_result(const StoreReader& store, const SearchResult& answer, const ResultHeader& header,
                  const std::filesystem::path& path, std::uint64_t memory_bytes, Progress& progress,
                  std::span<const double> chainage) {
  const HitSet& hits = answer.hits;
  const ClearanceSet& clearances = answer.clearances;
  const std::uint64_t collisions = hits.count();
  const std::uint64_t distances = clearances.count();
  ResultWriter writer(path, header, collisions, distances);
  progress.begin("write", collisions + distances, "points");
  write_set<Collision>(
      store, hits, collisions, memory_bytes, progress,
      [&](std::uint32_t cell) {
        return [&, q = store.coordinates(cell)](std::uint64_t source, std::uint64_t entry,
                                                std::uint32_t i) {
          return Collision{source,
                           {q[0][i], q[1][i], q[2][i]},
                           hits.has_first_pose() ? hits.first_pose(entry) : 0};
        };
      },
      [&](const std::vector<Collision>& rows) {
        append_rows(writer, rows, store.quantisation(), header.first_pose);
      });
  if (header.clearance > 0) {
    write_set<ClearanceRow>(
        store, clearances, distances, memory_bytes, progress,
        [&](std::uint32_t cell) {
          return [&, q = store.coordinates(cell)](std::uint64_t source, std::uint64_t entry,
                                                  std::uint32_t i) {
            const Clearance clearance = clearances.at(entry);
            return ClearanceRow{
                source, std::sqrt(clearance.squared), {q[0][i], q[1][i], q[2][i]}, clearance.pose};
          };
        },
        [&](const std::vector<ClearanceRow>& rows) {
          append_rows(writer, rows, store.quantisation());
        });
  }
  if (header.profile > 0) write_profile(store, answer.profile, chainage, writer, progress);
  writer.finish();
  progress.end();
}

std::uint64_t least_write_bytes() {
  return kBufferBytes + 2 * kRows * std::max(sizeof(Collision), sizeof(ClearanceRow));
}

}  // namespace clearway
