#include "search/find_depths.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <bit>
#include <vector>

#include "clearway/error.hpp"
#include "core/query/ignored_points.hpp"
#include "core/util/lane_bits.hpp"
#include "core/util/tsan_annotations.hpp"
#include "cpu/nearest_free.hpp"
#include "io/files/thread_limit.hpp"

namespace clearway {
namespace {

/// Blocks of a cell that a thread searches at a time.
constexpr std::uint32_t kBlocksAtOnce = 32;

std::uint64_t bytes_without_threads(const PackedCloud& cloud) {
  const std::uint64_t blocks = cloud.entry_count() / kBlockPoints;
  return blocks * sizeof(BlockBox) + FreePoints::bytes(cloud);
}

/// Bytes of each thread: the rows of the cell that it has begun, and its search.
std::uint64_t thread_bytes(const PackedCloud& cloud, const Query& query) {
  return AnswerRows::most_cell_bytes(cloud, query) + NearestFree::kBytes;
}

/// The threads for which there is memory.
int threads_in(const PackedCloud& cloud, const Query& query, int threads,
               std::uint64_t memory_bytes) {
  const std::uint64_t least = depth_search_bytes(cloud, query);
  if (least > memory_bytes) {
    throw ResourceError("the depths need more memory", Remedy::kMoreMemory,
                        static_cast<double>(least));
  }
  const std::uint64_t fit =
      (memory_bytes - bytes_without_threads(cloud)) / thread_bytes(cloud, query);
  return static_cast<int>(std::min<std::uint64_t>(static_cast<std::uint64_t>(threads), fit));
}

/// Finds the free points of all cells.
void add_free_points(const EnvironmentTree& tree, const Query& query, const AnswerRows& rows,
                     Progress& progress, FreePoints& free) {
  const IgnoredPoints ignored(tree.cloud(), query);
  const ParallelScope scope;
  const auto add = piece_of(scope, [&](std::size_t i) {
    throw_if_stopped(progress);
    const auto cell = static_cast<std::uint32_t>(i);
    const CellRows hits = rows.read(cell, PointQuestion::kHits);
    std::vector<std::uint64_t> taken = rows.read(cell, PointQuestion::kBelow).words;
    taken.resize(std::max(taken.size(), hits.words.size()));
    for (std::size_t word = 0; word < hits.words.size(); ++word) taken[word] |= hits.words[word];
    free.add_cell(cell, taken, ignored);
  });
  scope.begin();
  tbb::parallel_for(std::size_t{0}, tree.cloud().cells().size(), add);
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
  const ParallelScope scope;
  const auto search = piece_of(scope, [&](std::uint32_t part) {
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
  scope.begin();
  // Isolated, so that a thread that waits for this cell does not begin another one.
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(std::uint32_t{0},
                      static_cast<std::uint32_t>(divide_up(words.size(), kBlocksAtOnce)), search);
  });
  rows.add(cell, {{PointQuestion::kDepths, depths}});
}

}  // namespace

std::uint64_t depth_search_bytes(const PackedCloud& cloud, const Query& query) {
  return bytes_without_threads(cloud) + thread_bytes(cloud, query);
}

void find_depths(const StoreReader& store, const Query& query, AnswerRows& rows, int threads,
                 std::uint64_t memory_bytes, Progress& progress) {
  threads = threads_in(store, query, threads, memory_bytes);
  progress.begin("depth", rows.points(PointQuestion::kHits) - rows.points(PointQuestion::kDepths),
                 "points");
  std::vector<std::uint32_t> cells = rows.cells(PointQuestion::kHits);
  std::erase_if(cells,
                [&](std::uint32_t cell) { return rows.answered(cell, PointQuestion::kDepths); });
  if (!cells.empty()) {
    const EnvironmentTree tree(store, threads);
    FreePoints free(tree);
    in_threads(threads, [&] {
      add_free_points(tree, query, rows, progress, free);
      free.finish();
      Searches searches([&] { return NearestFree(tree, free); });
      const ParallelScope scope;
      const auto search =
          piece_of(scope, [&](std::size_t i) { search_cell(cells[i], searches, rows, progress); });
      scope.begin();
      tbb::parallel_for(std::size_t{0}, cells.size(), search);
    });
  }
  progress.end();
}

void check_depth(const StoreReader& store, const QueryParameters& query) {
  if (!query.depth || !store.metadata().near) return;
  throw UsageError(
      "the environment holds only points near a path, and depths need the whole scans: a free "
      "point that was left out may be nearer than those that were kept. Convert without --near");
}

}  // namespace clearway
