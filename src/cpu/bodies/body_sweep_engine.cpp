#include "cpu/bodies/body_sweep_engine.hpp"

#include <algorithm>

#include "core/cloud/kd_order.hpp"
#include "core/query/hit_set.hpp"

namespace clearway {
namespace {

/// The page in a slot, whose headers the engine may change.
PageCell* cells_in(std::span<std::byte> page) { return reinterpret_cast<PageCell*>(page.data()); }

std::uint32_t* nodes_in(std::span<std::byte> page, const PageShape& shape) {
  return reinterpret_cast<std::uint32_t*>(page.data() + shape.nodes_at());
}

}  // namespace

BodySweepEngine::BodySweepEngine(const PackedCloud& cloud, const Query& query,
                                 std::vector<SweptBody> bodies, const SlotLayout& layout)
    : cloud_(cloud),
      query_(query),
      numbers_(query),
      bodies_(std::move(bodies)),
      pool_(cloud, query, layout),
      results_(layout.slots) {
  if (!(query.profile > 0)) return;
  for (const SweptBody& body : bodies_) {
    std::visit([this](const auto* filter) { bests_.emplace_back(filter->ref()); }, body.filter);
  }
  facts_.resize(layout.slots);
}

void BodySweepEngine::start(std::uint32_t slot, const PageShape& shape) {
  const Clock::time_point begin = Clock::now();
  const PageRef page{pool_.page(slot).data(), shape};
  std::ranges::fill(pool_.hits(slot), 0);
  std::ranges::fill(pool_.first_poses(slot), HitSet::kNever);
  std::ranges::fill(pool_.clearances(slot), Clearance{});
  if (!facts_.empty()) facts_[slot].clear();
  const NodeRanges ranges = split_nodes(slot, shape);
  std::unique_ptr<Worker> worker = take_worker();
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    select_body(slot, shape, ranges, body);
    search_body(slot, page, body, *worker);
    if (!bests_.empty()) search_profile(slot, page, body);
  }
  give_back(std::move(worker));
  results_[slot] = pool_.result(slot, shape.cells);
  if (!facts_.empty()) results_[slot].profile = facts_[slot];
  results_[slot].compute = {begin, Clock::now()};
}

/// Numbers the nodes of each body by themselves. The nodes of a cell come body after body.
BodySweepEngine::NodeRanges BodySweepEngine::split_nodes(std::uint32_t slot,
                                                         const PageShape& shape) {
  PageCell* const cells = cells_in(pool_.page(slot));
  std::uint32_t* const nodes = nodes_in(pool_.page(slot), shape);
  NodeRanges ranges;
  ranges.reserve(shape.cells * (bodies_.size() + 1));
  for (std::uint32_t i = 0; i < shape.cells; ++i) {
    std::uint32_t at = cells[i].first_node;
    const std::uint32_t end = at + cells[i].node_count;
    for (std::size_t body = 0; body < bodies_.size(); ++body) {
      ranges.push_back(at);
      const bool last = body + 1 == bodies_.size();
      while (at < end && (last || nodes[at] < bodies_[body + 1].first_node)) {
        nodes[at++] -= bodies_[body].first_node;
      }
    }
    ranges.push_back(end);
  }
  return ranges;
}

/// The page becomes that of the one body.
void BodySweepEngine::select_body(std::uint32_t slot, const PageShape& shape,
                                  const NodeRanges& ranges, std::size_t body) {
  PageCell* const cells = cells_in(pool_.page(slot));
  for (std::uint32_t i = 0; i < shape.cells; ++i) {
    const std::uint32_t* const begin = &ranges[i * (bodies_.size() + 1) + body];
    cells[i].first_node = begin[0];
    cells[i].node_count = begin[1] - begin[0];
  }
}

void BodySweepEngine::search_body(std::uint32_t slot, const PageRef& page, std::size_t body,
                                  Worker& worker) {
  for (std::uint32_t i = 0; i < page.shape.cells; ++i) {
    if (page.cell(i).node_count == 0) continue;
    std::visit(
        [&](auto& search) {
          search.run(page, i, {worker.hits, worker.first_poses, worker.clearances});
        },
        worker.searches[body]);
    merge(body, worker, slot, i);
  }
}

void BodySweepEngine::merge(std::size_t body, const Worker& worker, std::uint32_t slot,
                            std::uint32_t cell) {
  const std::size_t blocks = cloud_.blocks_per_cell(), entries = cloud_.cell_entries();
  const auto hits = part_of_cell(pool_.hits(slot), cell, blocks);
  const auto first_poses = part_of_cell(pool_.first_poses(slot), cell, entries);
  const auto clearances = part_of_cell(pool_.clearances(slot), cell, entries);
  const auto number_of = [&](std::uint32_t pose) {
    return numbers_.number(bodies_[body].path_pose[pose], static_cast<std::uint32_t>(body));
  };
  for (std::size_t i = 0; i < hits.size(); ++i) hits[i] |= worker.hits[i];
  for (std::size_t i = 0; i < first_poses.size(); ++i) {
    const std::uint32_t pose = worker.first_poses[i];
    if (pose == HitSet::kNever) continue;
    first_poses[i] = std::min(first_poses[i], number_of(pose));
  }
  for (std::size_t i = 0; i < clearances.size(); ++i) {
    Clearance found = worker.clearances[i];
    if (!found.found()) continue;
    found.pose = number_of(found.pose);
    Clearance& least = clearances[i];
    const bool nearer = found.squared < least.squared;
    if (nearer || (found.squared == least.squared && found.pose < least.pose)) least = found;
  }
}

void BodySweepEngine::search_profile(std::uint32_t slot, const PageRef& page, std::size_t body) {
  std::vector<ProfileFact> found;
  const auto search_all = [&](const auto* filter) {
    HostProfileOf search(cloud_, filter->ref());
    search.search(page, bests_[body].ref(), found);
    return search.take_statistics();
  };
  const SweepStatistics statistics = std::visit(search_all, bodies_[body].filter);
  for (ProfileFact& fact : found) {
    fact.pose = bodies_[body].path_pose[fact.pose];
    facts_[slot].push_back(fact);
  }
  const std::lock_guard lock(mutex_);
  statistics_.add(statistics);
}

std::uint64_t BodySweepEngine::worker_bytes(const PackedCloud& cloud, const Query& query,
                                            std::uint64_t most_poses) {
  const std::uint64_t an_entry = (query.first_pose ? sizeof(std::uint32_t) : 0) +
                                 (query.clearance > 0 ? sizeof(Clearance) : 0);
  return sizeof(Worker) + cloud.blocks_per_cell() * sizeof(std::uint64_t) +
         cloud.cell_entries() * an_entry +
         query.bodies.size() *
             std::max({CellSearchOf<Vec3>::most_bytes(cloud, query, most_poses),
                       CellSearchOf<Triangle>::most_bytes(cloud, query, most_poses),
                       CellSearchOf<SolidTriangle>::most_bytes(cloud, query, most_poses)});
}

/// Facts of one body, of all bodies, and twice these while their list grows.
std::uint64_t BodySweepEngine::profile_bytes(const PackedCloud& cloud, const Query& query,
                                             const SlotLayout& layout, std::uint64_t most_poses) {
  if (!(query.profile > 0)) return 0;
  std::uint64_t bests = 0;
  for (const Body& body : query.bodies) bests += ProfileBestValues::size_bytes(body.poses.size());
  // The same of points and of triangles.
  const std::uint64_t of_body =
      HostProfileOf<Vec3>::most_facts(cloud, query.poses.size(), layout.cells, most_poses);
  return bests + layout.slots * 2 * (query.bodies.size() + 1) * of_body * sizeof(ProfileFact);
}

std::unique_ptr<BodySweepEngine::Worker> BodySweepEngine::take_worker() {
  const std::lock_guard lock(mutex_);
  if (!idle_.empty()) {
    std::unique_ptr<Worker> worker = std::move(idle_.back());
    idle_.pop_back();
    return worker;
  }
  auto worker = std::make_unique<Worker>();
  for (const SweptBody& body : bodies_) {
    std::visit(
        [&]<typename Element>(const SweepFilterOf<Element>* filter) {
          worker->searches.emplace_back(std::in_place_type<CellSearchOf<Element>>, cloud_, *filter);
        },
        body.filter);
  }
  worker->hits.resize(cloud_.blocks_per_cell());
  worker->first_poses.resize(query_.first_pose ? cloud_.cell_entries() : 0);
  worker->clearances.resize(query_.clearance > 0 ? cloud_.cell_entries() : 0);
  return worker;
}

void BodySweepEngine::give_back(std::unique_ptr<Worker> worker) {
  const std::lock_guard lock(mutex_);
  for (auto& any : worker->searches) {
    std::visit([this](auto& search) { statistics_.add(search.take_statistics()); }, any);
  }
  idle_.push_back(std::move(worker));
}

}  // namespace clearway
