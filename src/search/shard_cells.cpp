#include "search/shard_cells.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <queue>
#include <span>
#include <utility>

#include "core/sweep/field/model_field.hpp"
#include "core/sweep/sweep_filter.hpp"
#include "cpu/cell_search.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/files/thread_limit.hpp"
#include "io/files/xxh64.hpp"
#include "search/body_queries.hpp"
#include "search/memory_budget.hpp"
#include "search/query_trees.hpp"
#include "stream/plan.hpp"

namespace clearway {
namespace {

constexpr std::uint64_t kFieldBytes = std::uint64_t{16} << 20;

/// The number of blocks that are looked at: more of each cell where there are few cells, because
/// then their errors do not even out.
constexpr std::size_t kBlocks = 400'000, kLeastBlocksOfCell = 32;

/// The work to read a cell, and the work of a block with one pose, in the unit of the estimate.
constexpr double kCell = 1, kPose = 64;

/// A filter that is the same on all machines and for all memory budgets; that of a search may be
/// coarser, or on a GPU.
template <typename Element>
class WorkFilter {
 public:
  WorkFilter(const PackedCloud& cloud, const Query& query, const QueryTrees& trees, int threads)
      : field_(trees.model->field<Element>(query.radius,
                                           {.reach = std::max(query.clearance, query.profile),
                                            .most_bytes = kFieldBytes,
                                            .by_need = true},
                                           threads)),
        filter_(query, trees.motion, trees.of<Element>(), *field_, cloud, threads) {}

  const SweepFilterOf<Element>& get() const { return filter_; }

 private:
  std::shared_ptr<const ModelField> field_;
  SweepFilterOf<Element> filter_;
};

/// The work of a block with this many poses. A pose costs less where there are many, because most
/// points collide, or are dismissed, at the first ones. The exponent is measured
/// (docs/design/campaign.md).
double work_of_poses(std::uint64_t poses) {
  const double root = std::sqrt(static_cast<double>(poses));
  return root * std::sqrt(root);  // poses to the power of 3/4
}

/// The work of a cell, estimated from the poses that a search has to look at in each block.
template <typename Element>
double work_of(const PackedCloud& cloud, const SweepFilterOf<Element>& filter,
               const PlannedCell& planned, std::size_t most_blocks) {
  const Cell& cell = cloud.cells()[planned.cell];
  const std::size_t blocks = divide_up(cell.count, kBlockPoints);
  const std::size_t looks = std::min(blocks, most_blocks);
  std::vector<std::uint32_t> kept;
  SweepStatistics not_counted;
  double work = 0;
  for (std::size_t i = 0; i < looks; ++i) {
    const std::size_t block = (2 * i + 1) * blocks / (2 * looks);
    const Box box = cloud.block_box(planned.cell, static_cast<std::uint32_t>(block));
    if (filter.narrow(box, planned.nodes, kept, not_counted)) {
      continue;  // the whole block collides
    }
    work += work_of_poses(pose_count(filter.motion(), kept));
  }
  return kCell + kPose * work * static_cast<double>(blocks) / static_cast<double>(looks);
}

template <typename Element>
std::vector<std::uint64_t> cell_work_of(const PackedCloud& cloud, const Query& query,
                                        const QueryTrees& trees, int threads) {
  std::vector<std::uint64_t> work(cloud.cells().size());
  const WorkFilter<Element> filter(cloud, query, trees, threads);
  const std::vector<PlannedCell> cells = plan(cloud, filter.get());
  const std::size_t most_blocks =
      std::max(kLeastBlocksOfCell, kBlocks / std::max<std::size_t>(cells.size(), 1));
  ThreadLimit(threads).run([&] {
    for_each_parallel(cells.size(), [&](std::size_t i) {
      work[cells[i].cell] =
          static_cast<std::uint64_t>(work_of(cloud, filter.get(), cells[i], most_blocks));
    });
  });
  return work;
}

}  // namespace

std::vector<std::uint64_t> cell_work(const PackedCloud& cloud, const Query& query,
                                     const QueryTrees& trees, int threads) {
  return for_element_of(query.model, [&]<typename Element>() {
    return cell_work_of<Element>(cloud, query, trees, threads);
  });
}

std::uint64_t cell_work_bytes(const PackedCloud& cloud, const Query& query) {
  constexpr std::uint64_t kCellBytes = 128;  // a cell with its motion nodes
  // The most bytes that the filter keeps of model and motion for clearances.
  const std::uint64_t for_clearances =
      query.clearance > 0 ? 64 * (query.model.element_count() + query.poses.size()) : 0;
  return kFieldBytes + kFieldBytes / 4 + kCellBytes * cloud.cells().size() + for_clearances;
}

std::vector<std::uint32_t> divide_cells(std::span<const std::uint64_t> work, std::uint32_t shards) {
  std::vector<std::uint32_t> order(work.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, std::greater(), [&](std::uint32_t cell) { return work[cell]; });
  using Load = std::pair<std::uint64_t, std::uint32_t>;  // the part's work, and its number
  std::priority_queue<Load, std::vector<Load>, std::greater<>> loads;
  for (std::uint32_t shard = 0; shard < shards; ++shard) loads.emplace(0, shard);
  std::vector<std::uint32_t> parts(work.size());
  for (const std::uint32_t cell : order) {
    if (work[cell] == 0) {
      parts[cell] = cell % shards;
      continue;
    }
    const auto [load, shard] = loads.top();
    loads.pop();
    parts[cell] = shard;
    loads.emplace(load + work[cell], shard);
  }
  return parts;
}

namespace {

std::uint64_t division_of(const StoreReader& store, std::span<const std::uint32_t> parts) {
  const std::uint64_t fingerprint = store.fingerprint();
  Xxh64Stream hash;
  hash.update(std::as_bytes(std::span(&fingerprint, 1)));
  hash.update(std::as_bytes(parts));
  return hash.digest();
}

std::vector<std::uint64_t> work_of_cells(const StoreReader& store, const Query& query, int threads,
                                         std::uint64_t memory_bytes) {
  check_memory(program_bytes(threads) + input_bytes(store, query) + tree_building_bytes(query) +
                   cell_work_bytes(store, query),
               memory_bytes);
  std::vector<std::uint64_t> work(store.cells().size());
  const auto add = [&](const Query& body) {
    if (body.model.empty() || body.poses.empty()) return;
    const auto more = cell_work(store, body, QueryTrees(body, threads), threads);
    std::ranges::transform(work, more, work.begin(), std::plus());
  };
  if (query.bodies.empty()) add(query);
  for (const Query& body : body_queries(query)) add(body);
  return work;
}

}  // namespace

ShardCells::ShardCells(const StoreReader& store, const Query& query, const Shard& shard,
                       int threads, std::uint64_t memory_bytes)
    : own_(store.cells().size()) {
  const std::vector<std::uint64_t> work = work_of_cells(store, query, threads, memory_bytes);
  const std::vector<std::uint32_t> parts = divide_cells(work, shard.count);
  double all = 0, own = 0;
  for (std::size_t cell = 0; cell < parts.size(); ++cell) {
    own_[cell] = parts[cell] == shard.number - 1;
    all += static_cast<double>(work[cell]);
    if (own_[cell]) own += static_cast<double>(work[cell]);
  }
  if (all > 0) share_ = own * shard.count / all;
  part_ = {shard, division_of(store, parts), store.fingerprint()};
}

}  // namespace clearway
