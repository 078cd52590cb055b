#include "search/kinds/body_kind.hpp"

#include <algorithm>

#include "search/bodies/body_engine.hpp"
#include "search/bodies/body_queries.hpp"
#include "search/kinds/sweep_kind.hpp"

namespace clearway {
namespace {

/// The fewest slots of a GPU for a vehicle. Each slot of a GPU holds the page once for each body,
/// and takes that much longer to make. A page is also searched that much longer, so fewer pages are
/// in flight.
constexpr std::uint32_t kFewestSlotsOfGpu = 8;

PageEngineNeeds needs_of_bodies(PageEngineNeeds needs, std::size_t bodies) {
  if (!needs.on_gpu) return needs;
  const auto fewer = static_cast<std::uint32_t>(needs.most_slots / bodies);
  needs.most_slots = std::min(needs.most_slots, std::max(fewer, kFewestSlotsOfGpu));
  return needs;
}

/// make: makes the engine kind of one body from that body's query.
template <typename Make>
std::unique_ptr<PageEngineKind> body_kind(const StoreReader& store, const Query& query, Make make) {
  std::vector<Query> queries = body_queries(query);
  BodyKind::Kinds kinds;
  for (const Query& body : queries) kinds.push_back(make(body));
  return std::make_unique<BodyKind>(store, query, std::move(queries), std::move(kinds));
}

}  // namespace

BodyKind::BodyKind(const StoreReader& store, const Query& query, std::vector<Query> queries,
                   Kinds kinds)
    : PageEngineKind(needs_of_bodies(kinds.front()->needs(), kinds.size())),
      store_(store),
      query_(query),
      queries_(std::move(queries)),
      kinds_(std::move(kinds)) {
  const int threads = needs_.threads - needs_.waiting_threads;
  for (std::size_t body = 1; body < queries_.size(); ++body) {
    trees_.push_back(std::make_unique<QueryTrees>(queries_[body], threads));
  }
}

/// Index sizes for all bodies together.
std::vector<PageEngineKind::IndexSize> BodyKind::index_sizes() const {
  std::vector<IndexSize> sizes = kinds_.front()->index_sizes();
  for (IndexSize& size : sizes) {
    size.bytes *= kinds_.size();
    size.while_built *= kinds_.size();
  }
  return sizes;
}

const PoseReach& BodyKind::build_index(const QueryTrees& trees, std::uint64_t most_bytes) {
  reaches_.clear();
  first_nodes_.clear();
  std::uint32_t nodes = 0;
  for (std::size_t body = 0; body < kinds_.size(); ++body) {
    const QueryTrees& its = body == 0 ? trees : *trees_[body - 1];
    reaches_.push_back(&kinds_[body]->build_index(its, most_bytes / kinds_.size()));
    first_nodes_.push_back(nodes);
    nodes += static_cast<std::uint32_t>(its.motion.nodes().size());
  }
  return *reaches_.front();
}

/// Plans the cells that any body reaches, ordered by the first pose of the path at which a body
/// reaches them. Each cell has the motion nodes of one body after the other.
std::vector<PlannedCell> BodyKind::plan_cells(const PackedCloud& cloud, const PoseReach&) const {
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

std::uint64_t BodyKind::most_poses(const MotionTree&, std::span<const PlannedCell> cells) const {
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

void BodyKind::resolve_devices() {
  for (const auto& kind : kinds_) kind->resolve_devices();
  needs_ = needs_of_bodies(kinds_.front()->needs(), kinds_.size());
}

std::uint64_t BodyKind::index_bytes() const {
  std::uint64_t bytes = 0;
  for (const auto& kind : kinds_) bytes += kind->index_bytes();
  for (const auto& trees : trees_) bytes += trees->allocated_bytes();
  return bytes;
}

std::uint64_t BodyKind::host_bytes(const SlotLayout& layout, std::uint64_t most_poses) const {
  std::uint64_t bytes =
      needs_.devices * BodyEngine::answer_bytes(store_, query_, layout, most_poses);
  for (const auto& kind : kinds_) bytes += kind->host_bytes(layout, most_poses);
  return bytes;
}

std::uint64_t BodyKind::device_bytes(const SlotLayout& layout) const {
  std::uint64_t bytes = 0;
  for (const auto& kind : kinds_) bytes += kind->device_bytes(layout);
  return bytes;
}

void BodyKind::report_index(SearchReport& report, const MessageLog& log) const {
  for (const auto& kind : kinds_) {
    SearchReport of_body;
    kind->report_index(of_body, log);
    report.field_voxel = std::max(report.field_voxel, of_body.field_voxel);
  }
}

PageEngines BodyKind::make(const SlotLayout& layout) {
  std::vector<std::vector<SearchedBody>> of_device(needs_.devices);
  for (std::size_t body = 0; body < kinds_.size(); ++body) {
    PageEngines engines = kinds_[body]->make(layout);
    for (std::size_t device = 0; device < engines.size(); ++device) {
      of_device[device].push_back(
          {std::move(engines[device]), query_.bodies[body].path_pose, first_nodes_[body]});
    }
  }
  PageEngines engines;
  for (auto& bodies : of_device) {
    engines.push_back(std::make_unique<BodyEngine>(store_, query_, std::move(bodies), layout));
  }
  return engines;
}

void BodyKind::report_search(EngineList engines, SearchReport& report,
                             const MessageLog& log) const {
  for (std::size_t body = 0; body < kinds_.size(); ++body) {
    std::vector<const PageEngine*> of_body;
    for (const PageEngine* engine : engines) {
      of_body.push_back(&dynamic_cast<const BodyEngine&>(*engine).engine(body));
    }
    SearchReport taken;
    kinds_[body]->report_search(of_body, taken, log);
    report.peak_device_bytes += taken.peak_device_bytes;
    report.pinned_bytes += taken.pinned_bytes;
  }
}

std::unique_ptr<PageEngineKind> cpu_body_kind(const StoreReader& store, const Query& query,
                                              const SearchOptions& options) {
  return body_kind(store, query,
                   [&](const Query& body) { return cpu_sweep_kind(store, body, options); });
}

#ifdef CLEARWAY_CUDA
std::unique_ptr<PageEngineKind> cuda_body_kind(const StoreReader& store, const Query& query,
                                               const SearchOptions& options, const OpenGpus& open) {
  return body_kind(store, query,
                   [&](const Query& body) { return cuda_kind(store, body, options, open); });
}
#endif

}  // namespace clearway
