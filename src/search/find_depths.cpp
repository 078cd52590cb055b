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
#include "core/util/tsan_annotations.hpp"
#include "cpu/nearest_free.hpp"
#include "io/files/thread_limit.hpp"
#include "stream/gather_rows.hpp"

namespace clearway {
namespace {

/// Blocks of a cell that a thread searches at a time.
constexpr std::uint32_t kBlocksAtOnce = 32;

struct SomeBlocks {
  std::uint32_t cell, first;
};

/// All blocks of the cells that have colliding points, some at a time.
std::vector<SomeBlocks> blocks_of(const StoreReader& store, const SetCells& in) {
  std::vector<SomeBlocks> out;
  for (const std::uint32_t cell : in.cells) {
    const auto blocks =
        static_cast<std::uint32_t>(divide_up(store.cells()[cell].count, kBlockPoints));
    for (std::uint32_t first = 0; first < blocks; first += kBlocksAtOnce) {
      out.push_back({cell, first});
    }
  }
  return out;
}

std::uint64_t bytes_without_threads(const PackedCloud& cloud) {
  const std::uint64_t blocks = cloud.entry_count() / kBlockPoints;
  return blocks * sizeof(BlockBox) + FreePoints::bytes(cloud) +
         DepthSet::bytes(cloud.entry_count(), 0) +
         cloud.cells().size() * (sizeof(SomeBlocks) + 2 * sizeof(std::uint32_t)) +
         2 * blocks / kBlocksAtOnce * sizeof(SomeBlocks);
}

/// The threads for which there is memory.
int threads_in(const DepthSearch& search, std::uint64_t without_threads) {
  const std::uint64_t least = without_threads + NearestFree::kBytes;
  if (least > search.memory_bytes) {
    throw ResourceError("the depths need more memory", Remedy::kMoreMemory,
                        static_cast<double>(least));
  }
  const std::uint64_t fit = (search.memory_bytes - without_threads) / NearestFree::kBytes;
  return static_cast<int>(std::min<std::uint64_t>(static_cast<std::uint64_t>(search.threads), fit));
}

/// Finds the free points of all cells.
void add_free_points(const EnvironmentTree& tree, const DepthSearch& search, Progress& progress,
                     FreePoints& free) {
  const IgnoredPoints ignored(tree.cloud(), search.query);
  const ParallelScope scope;
  const auto add = piece_of(scope, [&](std::size_t cell) {
    throw_if_stopped(progress);
    free.add_cell(static_cast<std::uint32_t>(cell), search.found.hits, search.below, ignored);
  });
  scope.begin();
  tbb::parallel_for(std::size_t{0}, tree.cloud().cells().size(), add);
}

void search_blocks(const EnvironmentTree& tree, const SomeBlocks& blocks, const HitSet& hits,
                   NearestFree& nearest, DepthSet& depths, Progress& progress) {
  std::array<Depth, kBlockPoints> found;
  const std::uint32_t end =
      std::min(blocks.first + kBlocksAtOnce, tree.cell(blocks.cell).block_count);
  for (std::uint32_t block = blocks.first; block < end; ++block) {
    const std::uint64_t index = tree.block_index(blocks.cell, block);
    const std::uint64_t points = hits.word(index);
    if (points == 0) continue;
    throw_if_stopped(progress);
    nearest.search(blocks.cell, block, points, found);
    for (std::uint64_t bits = points; bits != 0; bits &= bits - 1) {
      const auto i = static_cast<std::uint32_t>(std::countr_zero(bits));
      depths.set(hits, index * kBlockPoints + i, found[i]);
    }
    progress.advance(static_cast<std::uint64_t>(std::popcount(points)));
  }
}

}  // namespace

std::uint64_t depth_search_bytes(const PackedCloud& cloud) {
  return bytes_without_threads(cloud) + NearestFree::kBytes;
}

DepthSet find_depths(const StoreReader& store, const DepthSearch& search, Progress& progress) {
  const HitSet& hits = search.found.hits;
  const SetCells in =
      in_threads(search.threads, [&] { return cells_of(store, hits, search.found.cells); });
  const int threads = threads_in(search, bytes_without_threads(store) + in.entries * sizeof(Depth));
  progress.begin("depth", in.entries, "points");
  DepthSet depths(hits, store.entry_count());
  if (in.entries > 0) {
    const EnvironmentTree tree(store, threads);
    FreePoints free(tree);
    in_threads(threads, [&] {
      add_free_points(tree, search, progress, free);
      free.finish();
      const std::vector<SomeBlocks> blocks = blocks_of(store, in);
      tbb::enumerable_thread_specific<NearestFree> of_thread(
          [&] { return NearestFree(tree, free); });
      const ParallelScope scope;
      const auto search_some = piece_of(scope, [&](std::size_t i) {
        search_blocks(tree, blocks[i], hits, of_thread.local(), depths, progress);
      });
      scope.begin();
      tbb::parallel_for(std::size_t{0}, blocks.size(), search_some);
    });
  }
  progress.end();
  return depths;
}

void check_depth(const StoreReader& store, const QueryParameters& query) {
  if (!query.depth || !store.metadata().near) return;
  throw UsageError(
      "the environment holds only points near a path, and depths need the whole scans: a free "
      "point that was left out may be nearer than those that were kept. Convert without --near");
}

}  // namespace clearway
