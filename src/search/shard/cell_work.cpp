#include "search/shard/cell_work.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/sweep/field/model_field.hpp"
#include "core/sweep/sweep_filter.hpp"
#include "core/sweep/tolerance.hpp"
#include "core/util/tsan_annotations.hpp"
#include "cpu/cell_search.hpp"
#include "io/system/thread_limit.hpp"
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
      : field_(trees.of<Element>(), search_radius(query),
               {.reach = std::max(query.clearance, query.profile),
                .most_bytes = kFieldBytes,
                .by_need = true,
                .solids = trees.solids_of<Element>()},
               threads),
        filter_(query, trees.motion, trees.of<Element>(), field_, cloud, threads) {}

  const SweepFilterOf<Element>& get() const { return filter_; }

 private:
  ModelField field_;
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
  const std::size_t first = std::size_t{planned.cell} * cloud.blocks_per_cell();
  const std::size_t blocks = divide_up(cell.count, kBlockPoints);
  const std::size_t looks = std::min(blocks, most_blocks);
  std::vector<std::uint32_t> kept;
  SweepStatistics not_counted;
  double work = 0;
  for (std::size_t i = 0; i < looks; ++i) {
    const std::size_t block = (2 * i + 1) * blocks / (2 * looks);
    const QuantumBox box = decode_block_box(cell.box, cloud.blocks()[first + block]);
    if (filter.narrow(position_box(cloud.quantisation(), box), planned.nodes, kept, not_counted)) {
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
  const ParallelScope scope;
  const auto look = piece_of(scope, [&](std::size_t i) {
    work[cells[i].cell] =
        static_cast<std::uint64_t>(work_of(cloud, filter.get(), cells[i], most_blocks));
  });
  scope.begin();
  ThreadLimit(threads).run([&] { tbb::parallel_for(std::size_t{0}, cells.size(), look); });
  return work;
}

}  // namespace

std::vector<std::uint64_t> cell_work(const PackedCloud& cloud, const Query& query,
                                     const QueryTrees& trees, int threads) {
  if (query.model.is_solid()) return cell_work_of<SolidTriangle>(cloud, query, trees, threads);
  return query.model.is_surface() ? cell_work_of<Triangle>(cloud, query, trees, threads)
                                  : cell_work_of<Vec3>(cloud, query, trees, threads);
}

std::uint64_t cell_work_bytes(const PackedCloud& cloud, const Query& query) {
  constexpr std::uint64_t kCellBytes = 128;  // a cell with its motion nodes
  // The most bytes that the filter keeps of model and motion for clearances.
  const std::uint64_t for_clearances =
      query.clearance > 0 ? 64 * (query.model.element_count() + query.poses.size()) : 0;
  return kFieldBytes + kFieldBytes / 4 + kCellBytes * cloud.cells().size() + for_clearances;
}

}  // namespace clearway
