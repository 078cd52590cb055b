#include "search/find_depths.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <bit>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "core/query/ignored_points.hpp"
#include "core/util/lane_bits.hpp"
#include "cpu/nearest_free.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/files/thread_limit.hpp"

namespace clearway {
namespace {

/// Blocks of a cell that a thread searches at a time.
constexpr std::uint32_t kBlocksAtOnce = 32;

/// Bytes of each thread: the rows of the cell that it has begun, and its search.
std::uint64_t thread_bytes(const PackedCloud& cloud, const Query& query) {
  return AnswerRows::most_cell_bytes(cloud, query) + NearestFree::bytes(cloud);
}

/// The threads for which there is memory beside `free_bytes` for free points.
int threads_in(const PackedCloud& cloud, const Query& query, std::uint64_t free_bytes, int threads,
               std::uint64_t memory_bytes) {
  const std::uint64_t of_thread = thread_bytes(cloud, query);
  if (free_bytes + of_thread > memory_bytes) {
    throw ResourceError("the depths need more memory", Remedy::kMoreMemory,
                        static_cast<double>(free_bytes + of_thread));
  }
  const std::uint64_t fit = (memory_bytes - free_bytes) / of_thread;
  return static_cast<int>(std::min<std::uint64_t>(static_cast<std::uint64_t>(threads), fit));
}

/// The cells in which points may not be free: they collide, with a floor or without it, or are
/// ignored.
std::vector<std::uint32_t> cells_not_free(const StoreReader& store, const AnswerRows& rows,
                                          const IgnoredPoints& ignored) {
  std::vector<bool> is_one(store.cells().size());
  for (const PointQuestion question : {PointQuestion::kHits, PointQuestion::kBelow}) {
    for (const std::uint32_t cell : rows.cells(question)) is_one[cell] = true;
  }
  std::vector<std::uint32_t> cells;
  for (std::uint32_t cell = 0; cell < is_one.size(); ++cell) {
    if (is_one[cell] || (ignored.any() && ignored.touches(cell))) cells.push_back(cell);
  }
  return cells;
}

/// Finds the free points of the cells in which not all are free.
void add_free_points(std::span<const std::uint32_t> cells, const IgnoredPoints& ignored,
                     const AnswerRows& rows, Progress& progress, FreePoints& free) {
  for_each_parallel(cells.size(), [&](std::size_t i) {
    throw_if_stopped(progress);
    const CellRows hits = rows.read(cells[i], PointQuestion::kHits);
    std::vector<std::uint64_t> taken = rows.read(cells[i], PointQuestion::kBelow).words;
    taken.resize(std::max(taken.size(), hits.words.size()));
    for (std::size_t word = 0; word < hits.words.size(); ++word) taken[word] |= hits.words[word];
    free.add_cell(cells[i], taken, ignored);
  });
  free.finish();
}

using Searches = tbb::enumerable_thread_specific<NearestFree>;

/// Finds the depths of a cell, some blocks at a time, and adds them.
void search_cell(std::uint32_t cell, Searches& searches, AnswerRows& rows, Progress& progress) {
  const RowFinder hits(rows.read(cell, PointQuestion::kHits));
  const std::vector<std::uint64_t>& words = hits.rows().words;
  const std::uint64_t count = hits.rows().count();
  CellRows depths{.words = words,
                  .distances = std::vector<double>(count),
                  .sources = std::vector<std::uint64_t>(count)};
  const auto parts = static_cast<std::uint32_t>(divide_up(words.size(), kBlocksAtOnce));
  for_each_nested(parts, [&](std::uint32_t part) {
    NearestFree& nearest = searches.local();
    std::array<Depth, kBlockPoints> found;
    const std::uint32_t first = part * kBlocksAtOnce;
    const auto end = std::min(first + kBlocksAtOnce, static_cast<std::uint32_t>(words.size()));
    for (std::uint32_t block = first; block < end; ++block) {
      if (words[block] == 0) continue;
      throw_if_stopped(progress);
      nearest.search(cell, block, words[block], found);
      for_each_bit(words[block], [&](std::uint32_t i) {
        const std::size_t row = hits.row_of(block * kBlockPoints + i);
        depths.distances[row] = found[i].distance;
        depths.sources[row] = found[i].source;
      });
      progress.advance(static_cast<std::uint64_t>(std::popcount(words[block])));
    }
  });
  std::vector<AnswerRows::Part> found;
  found.push_back({PointQuestion::kDepths, std::move(depths)});
  rows.add(cell, found);
}

}  // namespace

std::uint64_t depth_search_bytes(const PackedCloud& cloud, const Query& query) {
  return FreePoints::bytes(cloud, 0) + thread_bytes(cloud, query);
}

std::uint64_t find_depths(const StoreReader& store, const Query& query, AnswerRows& rows,
                          int threads, std::uint64_t memory_bytes, Progress& progress) {
  const IgnoredPoints ignored(store, query);
  const std::vector<std::uint32_t> not_free = cells_not_free(store, rows, ignored);
  threads =
      threads_in(store, query, FreePoints::bytes(store, not_free.size()), threads, memory_bytes);
  progress.begin("depth", rows.points(PointQuestion::kHits) - rows.points(PointQuestion::kDepths),
                 "points");
  std::vector<std::uint32_t> cells = rows.cells(PointQuestion::kHits);
  std::erase_if(cells,
                [&](std::uint32_t cell) { return rows.answered(cell, PointQuestion::kDepths); });
  if (!cells.empty()) {
    const EnvironmentTree tree(store);
    FreePoints free(tree, not_free);
    in_threads(threads, [&] {
      add_free_points(not_free, ignored, rows, progress, free);
      Searches searches([&] { return NearestFree(tree, free); });
      for_each_parallel(cells.size(),
                        [&](std::size_t i) { search_cell(cells[i], searches, rows, progress); });
    });
  }
  progress.end();
  return FreePoints::bytes(store, not_free.size()) - FreePoints::bytes(store, 0);
}

void check_depth(const StoreReader& store, const QueryParameters& query) {
  if (!query.depth || !store.metadata().near) return;
  throw UsageError(
      "the environment holds only points near a path, and depths need the whole scans: a free "
      "point that was left out may be nearer than those that were kept. Convert without --near");
}

}  // namespace clearway
