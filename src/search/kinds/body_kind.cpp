#include "search/kinds/body_kind.hpp"

#include <algorithm>
#include <cstdint>
#include <exception>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "core/page/page_engine.hpp"
#include "core/page/page_pool.hpp"
#include "core/query/body_numbers.hpp"
#include "core/query/search_result.hpp"
#include "core/sweep/profile/host_profile.hpp"
#include "search/body_queries.hpp"
#include "search/kinds/sweep_kind.hpp"

namespace clearway {
namespace {

/// The engine that searches the model of one body at the poses of that body.
struct SearchedBody {
  std::unique_ptr<PageEngine> engine;
  /// For each pose of the body, the index of the pose of the path that it belongs to.
  std::span<const std::uint32_t> path_pose;
  /// The number of the body's first motion node in a page, where nodes are numbered over all
  /// bodies.
  std::uint32_t first_node;
};

/// The engines of several bodies as one engine, on any device. Every page is searched by all of
/// them, and for each point the smallest of the BodyNumbers is kept.
class BodyEngine final : public PageEngine {
 public:
  /// query: the query with all bodies. layout: the one that each body's engine has. What the bodies
  /// refer to outlives this engine. Allocates answer_bytes().
  BodyEngine(const PackedCloud& cloud, const Query& query, std::vector<SearchedBody> bodies,
             const SlotLayout& layout);

  std::uint32_t slots() const override { return answers_.layout().slots; }
  bool pages_alike() const override { return bodies_.front().engine->pages_alike(); }
  std::span<std::byte> page(std::uint32_t slot) override {
    return bodies_.front().engine->page(slot);
  }
  std::optional<CellPayload> kept(std::uint32_t slot, std::uint32_t cell) override;
  void start(std::uint32_t slot, const PageShape& shape) override;
  void wait(std::uint32_t slot) override;
  PageResult finish(std::uint32_t slot) override;

  PageEngine& engine(std::size_t body) const { return *bodies_[body].engine; }

  /// Bytes of memory for the answers of all slots, besides what the bodies' engines take.
  /// most_poses: the most poses of the motion nodes of any cell, for all bodies together.
  static std::uint64_t answer_bytes(const PackedCloud& cloud, const Query& query,
                                    const SlotLayout& layout, std::uint64_t most_poses);

 private:
  void keep_nodes(std::span<std::byte> page, const PageShape& shape, std::size_t body) const;
  void make_room(std::uint32_t slot, std::span<const PageResult> found);
  void merge(std::uint32_t slot, std::size_t body, const PageResult& found);
  template <typename Call>
  void for_all(Call call) const;

  const BodyNumbers numbers_;
  std::vector<SearchedBody> bodies_;
  PagePool answers_;
  /// For each slot, the number of cells of its page.
  std::vector<std::uint32_t> cells_;
  /// For each slot, the profile facts of its page.
  std::vector<std::vector<ProfileFact>> facts_;
};

/// The layout of the answers' slots, which have no page: pages are in the slots of the bodies'
/// engines.
SlotLayout without_pages(SlotLayout layout) {
  layout.page_bytes = 0;
  return layout;
}

void extend(Interval& whole, const Interval& part) {
  whole = {std::min(whole.begin, part.begin), std::max(whole.end, part.end)};
}

BodyEngine::BodyEngine(const PackedCloud& cloud, const Query& query,
                       std::vector<SearchedBody> bodies, const SlotLayout& layout)
    : numbers_(query),
      bodies_(std::move(bodies)),
      answers_(cloud, query, without_pages(layout)),
      cells_(layout.slots),
      facts_(layout.slots) {}

/// The caller has filled the first body's page. The other bodies get copies of it without the
/// coordinates, which they find where the first body has them, so that a GPU gets them once.
void BodyEngine::start(std::uint32_t slot, const PageShape& shape) {
  cells_[slot] = shape.cells;
  PageEngine& first = *bodies_.front().engine;
  const std::span<std::byte> filled = first.page(slot).first(shape.payload_at());
  for (std::size_t body = bodies_.size(); body-- > 0;) {
    const std::span<std::byte> own = bodies_[body].engine->page(slot);
    if (body > 0) std::ranges::copy(filled, own.begin());
    keep_nodes(own, shape, body);
  }
  PageShape without_payloads = shape;
  without_payloads.payload_bytes = 0;
  std::size_t started = 0;
  try {
    first.start(slot, shape);
    while (++started < bodies_.size()) {
      bodies_[started].engine->start_beside(first, slot, without_payloads);
    }
  } catch (...) {
    while (started-- > 0) {
      try {
        bodies_[started].engine->finish(slot);
      } catch (...) {  // only the first failure is thrown
      }
    }
    throw;
  }
}

/// Where the first body's engine finds a cell that the engines of all bodies find, each of which
/// then holds it until its own search is finished.
std::optional<CellPayload> BodyEngine::kept(std::uint32_t slot, std::uint32_t cell) {
  std::optional<CellPayload> first = bodies_.front().engine->kept(slot, cell);
  for (std::size_t body = 1; body < bodies_.size() && first; ++body) {
    if (!bodies_[body].engine->kept(slot, cell)) first.reset();
  }
  return first;
}

/// Reduces the nodes of every cell of a page to those of one body, renumbered from 0. A cell's
/// nodes come body after body, numbered over all bodies.
void BodyEngine::keep_nodes(std::span<std::byte> page, const PageShape& shape,
                            std::size_t body) const {
  const std::uint32_t begin = bodies_[body].first_node;
  const std::uint32_t end = body + 1 < bodies_.size() ? bodies_[body + 1].first_node
                                                      : std::numeric_limits<std::uint32_t>::max();
  auto* const cells = reinterpret_cast<PageCell*>(page.data());
  const std::span nodes(reinterpret_cast<std::uint32_t*>(page.data() + shape.nodes_at()),
                        shape.nodes);
  for (PageCell& cell : std::span(cells, shape.cells)) {
    const auto of_cell = nodes.subspan(cell.first_node, cell.node_count);
    const auto before = [](std::uint32_t bound) {
      return [bound](std::uint32_t node) { return node < bound; };
    };
    const auto first = std::ranges::partition_point(of_cell, before(begin));
    const auto last = std::partition_point(first, of_cell.end(), before(end));
    for (auto node = first; node != last; ++node) *node -= begin;
    cell.first_node += static_cast<std::uint32_t>(first - of_cell.begin());
    cell.node_count = static_cast<std::uint32_t>(last - first);
  }
}

/// Makes the call for every body. The first failure is thrown after the last call.
template <typename Call>
void BodyEngine::for_all(Call call) const {
  std::exception_ptr failure;
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    try {
      call(body);
    } catch (...) {
      if (!failure) failure = std::current_exception();
    }
  }
  if (failure) std::rethrow_exception(failure);
}

void BodyEngine::wait(std::uint32_t slot) {
  for_all([&](std::size_t body) { bodies_[body].engine->wait(slot); });
}

PageResult BodyEngine::finish(std::uint32_t slot) {
  std::vector<PageResult> found(bodies_.size());
  for_all([&](std::size_t body) { found[body] = bodies_[body].engine->finish(slot); });
  std::ranges::fill(answers_.hits(slot), 0);
  std::ranges::fill(answers_.first_poses(slot), kNoPose);
  std::ranges::fill(answers_.clearances(slot), Clearance{});
  make_room(slot, found);
  PageResult result = answers_.result(slot, cells_[slot]);
  result.upload = found.front().upload;
  result.compute = found.front().compute;
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    merge(slot, body, found[body]);
    extend(result.upload, found[body].upload);
    extend(result.compute, found[body].compute);
  }
  result.profile = facts_[slot];
  return result;
}

/// Empties the slot's profile facts and reserves memory for those of all bodies, and no more.
void BodyEngine::make_room(std::uint32_t slot, std::span<const PageResult> found) {
  std::size_t facts = 0;
  for (const PageResult& of_body : found) facts += of_body.profile.size();
  if (facts_[slot].capacity() < facts) facts_[slot] = {};
  facts_[slot].clear();
  facts_[slot].reserve(facts);
}

void BodyEngine::merge(std::uint32_t slot, std::size_t body, const PageResult& found) {
  const std::span<const std::uint32_t> path_pose = bodies_[body].path_pose;
  const auto number_of = [&](std::uint32_t pose) {
    return numbers_.number(path_pose[pose], static_cast<std::uint32_t>(body));
  };
  const auto hits = answers_.hits(slot);
  for (std::size_t i = 0; i < found.hits.size(); ++i) hits[i] |= found.hits[i];
  const auto first_poses = answers_.first_poses(slot);
  for (std::size_t i = 0; i < found.first_poses.size(); ++i) {
    const std::uint32_t pose = found.first_poses[i];
    if (pose != kNoPose) first_poses[i] = std::min(first_poses[i], number_of(pose));
  }
  const auto clearances = answers_.clearances(slot);
  for (std::size_t i = 0; i < found.clearances.size(); ++i) {
    Clearance other = found.clearances[i];
    if (!other.found()) continue;
    other.pose = number_of(other.pose);
    Clearance& least = clearances[i];
    const bool nearer = other.squared < least.squared;
    if (nearer || (other.squared == least.squared && other.pose < least.pose)) least = other;
  }
  for (ProfileFact fact : found.profile) {
    fact.pose = path_pose[fact.pose];
    facts_[slot].push_back(fact);
  }
}

std::uint64_t BodyEngine::answer_bytes(const PackedCloud& cloud, const Query& query,
                                       const SlotLayout& layout, std::uint64_t most_poses) {
  const std::uint64_t answers =
      layout.slots * PagePool::slot_bytes(cloud, query, without_pages(layout));
  if (!(query.profile > 0)) return answers;
  // Models of points and of triangles have the same bound.
  const std::uint64_t of_body =
      HostProfileOf<Vec3>::most_facts(cloud, query.poses.size(), layout.cells, most_poses);
  return answers + layout.slots * query.bodies.size() * of_body * sizeof(ProfileFact);
}

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
std::unique_ptr<PageEngineKind> body_kind(const PackedCloud& cloud, const Query& query, Make make) {
  std::vector<Query> queries = body_queries(query);
  BodyKind::Kinds kinds;
  for (const Query& body : queries) kinds.push_back(make(body));
  return std::make_unique<BodyKind>(cloud, query, std::move(queries), std::move(kinds));
}

}  // namespace

BodyKind::BodyKind(const PackedCloud& cloud, const Query& query, std::vector<Query> queries,
                   Kinds kinds)
    : PageEngineKind(needs_of_bodies(kinds.front()->needs(), kinds.size())),
      cloud_(cloud),
      query_(query),
      queries_(std::move(queries)),
      kinds_(std::move(kinds)) {}

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
  for (std::size_t body = trees_.size() + 1; body < queries_.size(); ++body) {
    trees_.push_back(std::make_unique<QueryTrees>(trees_of(queries_[body], body)));
  }
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
      needs_.devices * BodyEngine::answer_bytes(cloud_, query_, layout, most_poses);
  for (const auto& kind : kinds_) bytes += kind->host_bytes(layout, most_poses);
  return bytes;
}

std::uint64_t BodyKind::device_bytes(const SlotLayout& layout) const {
  std::uint64_t bytes = 0;
  for (const auto& kind : kinds_) bytes += kind->device_bytes(layout);
  return bytes;
}

void BodyKind::log_index(const MessageLog& log) const {
  for (const auto& kind : kinds_) kind->log_index(log);
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
    engines.push_back(std::make_unique<BodyEngine>(cloud_, query_, std::move(bodies), layout));
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

std::unique_ptr<PageEngineKind> cpu_body_kind(const PackedCloud& cloud, const Query& query,
                                              const SearchOptions& options) {
  return body_kind(cloud, query,
                   [&](const Query& body) { return cpu_sweep_kind(cloud, body, options); });
}

#ifdef CLEARWAY_CUDA
std::unique_ptr<PageEngineKind> cuda_body_kind(const PackedCloud& cloud, const Query& query,
                                               const SearchOptions& options, const OpenGpus& open,
                                               KeptOnGpus* kept) {
  return body_kind(cloud, query,
                   [&](const Query& body) { return cuda_kind(cloud, body, options, open, kept); });
}
#endif

}  // namespace clearway
