#include "search/kinds/body_kind.hpp"

#include <algorithm>

#include "core/util/format.hpp"
#include "cpu/bodies/body_sweep_engine.hpp"
#include "search/bodies/body_queries.hpp"

namespace clearway {
namespace {

/// What cpu_sweep_kind()'s index is.
BodyFilter filter_of(const PoseReach& reach, const Query& body) {
  if (body.is_solid()) return &dynamic_cast<const SweepFilterOf<SolidTriangle>&>(reach);
  if (body.is_surface()) return &dynamic_cast<const SweepFilterOf<Triangle>&>(reach);
  return &dynamic_cast<const SweepFilterOf<Vec3>&>(reach);
}

}  // namespace

CpuBodyKind::CpuBodyKind(const StoreReader& store, const Query& query, const SearchOptions& options)
    : PageEngineKind({.most_slots = static_cast<std::uint32_t>(options.threads) + kSlotsAhead,
                      .threads = options.threads}),
      store_(store),
      query_(query),
      options_(options),
      queries_(body_queries(query)) {
  for (const Query& body : queries_) {
    sweeps_.push_back(cpu_sweep_kind(store_, body, options_));
    if (sweeps_.size() == 1) continue;
    trees_.push_back(std::make_unique<QueryTrees>(body, options_.threads));
  }
}

/// Of all bodies together.
std::vector<PageEngineKind::IndexSize> CpuBodyKind::index_sizes() const {
  std::vector<IndexSize> sizes = sweeps_.front()->index_sizes();
  for (IndexSize& size : sizes) {
    size.bytes *= sweeps_.size();
    size.while_built *= sweeps_.size();
  }
  return sizes;
}

const PoseReach& CpuBodyKind::build_index(const QueryTrees& trees, std::uint64_t most_bytes) {
  reaches_.clear();
  first_nodes_.clear();
  std::uint32_t nodes = 0;
  for (std::size_t body = 0; body < sweeps_.size(); ++body) {
    const QueryTrees& its = body == 0 ? trees : *trees_[body - 1];
    reaches_.push_back(&sweeps_[body]->build_index(its, most_bytes / sweeps_.size()));
    first_nodes_.push_back(nodes);
    nodes += static_cast<std::uint32_t>(its.motion.nodes().size());
  }
  return *reaches_.front();
}

/// The cells of all bodies, each with the nodes of one body after the other, in the order in which
/// the first of the bodies reaches them.
std::vector<PlannedCell> CpuBodyKind::plan_cells(const PackedCloud& cloud, const PoseReach&) const {
  struct Reached {
    PlannedCell cell;
    std::uint32_t first_pose = ~std::uint32_t{0};
  };
  std::vector<Reached> reached(cloud.cells().size());
  for (std::size_t body = 0; body < reaches_.size(); ++body) {
    for (const PlannedCell& planned : plan(cloud, *reaches_[body])) {
      Reached& of = reached[planned.cell];
      of.cell.cell = planned.cell;
      const std::uint32_t pose = reaches_[body]->motion().nodes()[planned.nodes.front()].first;
      of.first_pose = std::min(of.first_pose, query_.bodies[body].path_pose[pose]);
      of.cell.nodes.reserve(of.cell.nodes.size() + planned.nodes.size());
      for (const std::uint32_t node : planned.nodes) {
        of.cell.nodes.push_back(first_nodes_[body] + node);
      }
    }
  }
  std::erase_if(reached, [](const Reached& of) { return of.cell.nodes.empty(); });
  std::ranges::stable_sort(reached, {}, &Reached::first_pose);
  std::vector<PlannedCell> cells;
  cells.reserve(reached.size());
  for (Reached& of : reached) cells.push_back(std::move(of.cell));
  return cells;
}

std::uint64_t CpuBodyKind::most_poses(const MotionTree&, std::span<const PlannedCell> cells) const {
  std::uint64_t most = 0;
  for (const PlannedCell& cell : cells) {
    std::uint64_t poses = 0;
    for (const std::uint32_t node : cell.nodes) {
      const auto after = std::ranges::upper_bound(first_nodes_, node);
      const auto body = static_cast<std::size_t>(after - first_nodes_.begin()) - 1;
      poses += reaches_[body]->motion().nodes()[node - first_nodes_[body]].count;
    }
    most = std::max(most, poses);
  }
  return most;
}

std::uint64_t CpuBodyKind::index_bytes() const {
  std::uint64_t bytes = 0;
  for (const auto& sweep : sweeps_) bytes += sweep->index_bytes();
  for (const auto& trees : trees_) bytes += trees->allocated_bytes();
  return bytes;
}

std::uint64_t CpuBodyKind::host_bytes(const SlotLayout& layout, std::uint64_t most_poses) const {
  const auto threads = static_cast<std::uint32_t>(options_.threads);
  return layout.slots * PagePool::slot_bytes(store_, query_, layout) +
         std::min(layout.slots, threads) *
             BodySweepEngine::worker_bytes(store_, query_, most_poses) +
         BodySweepEngine::profile_bytes(store_, query_, layout, most_poses);
}

void CpuBodyKind::report_index(SearchReport& report, const MessageLog& log) const {
  for (const auto& sweep : sweeps_) {
    SearchReport of_body;
    sweep->report_index(of_body, log);
    report.field_voxel = std::max(report.field_voxel, of_body.field_voxel);
  }
}

PageEngines CpuBodyKind::make(const SlotLayout& layout) {
  std::vector<SweptBody> bodies;
  for (std::size_t body = 0; body < reaches_.size(); ++body) {
    bodies.push_back({filter_of(*reaches_[body], queries_[body]), query_.bodies[body].path_pose,
                      first_nodes_[body]});
  }
  PageEngines engines;
  engines.push_back(std::make_unique<BodySweepEngine>(store_, query_, std::move(bodies), layout));
  return engines;
}

void CpuBodyKind::report_search(const PageEngines& engines, SearchReport& report,
                                const MessageLog& log) const {
  SweepKindOf<Vec3>::report_statistics(
      dynamic_cast<const BodySweepEngine&>(*engines.front()).statistics(), report, log);
}

}  // namespace clearway
