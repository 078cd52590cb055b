#include "search/bodies/body_engine.hpp"

#include <algorithm>
#include <exception>
#include <limits>

#include "core/query/hit_set.hpp"
#include "core/sweep/profile/host_profile.hpp"

namespace clearway {
namespace {

/// The layout of the answers' slots, which have no page: pages are in the slots of the bodies'
/// engines.
SlotLayout without_pages(SlotLayout layout) {
  layout.page_bytes = 0;
  return layout;
}

void extend(Interval& whole, const Interval& part) {
  whole = {std::min(whole.begin, part.begin), std::max(whole.end, part.end)};
}

}  // namespace

BodyEngine::BodyEngine(const PackedCloud& cloud, const Query& query,
                       std::vector<SearchedBody> bodies, const SlotLayout& layout)
    : numbers_(query),
      bodies_(std::move(bodies)),
      answers_(cloud, query, without_pages(layout)),
      cells_(layout.slots),
      facts_(layout.slots) {}

/// The caller has filled the first body's page. The other bodies get copies of it before its nodes
/// are reduced to the first body's own.
void BodyEngine::start(std::uint32_t slot, const PageShape& shape) {
  cells_[slot] = shape.cells;
  const std::span<const std::byte> filled = page(slot).first(shape.bytes());
  std::size_t body = bodies_.size();
  try {
    while (body-- > 0) {
      PageEngine& engine = *bodies_[body].engine;
      const std::span<std::byte> own = engine.page(slot);
      if (body > 0) std::ranges::copy(filled, own.begin());
      keep_nodes(own, shape, body);
      engine.start(slot, shape);
    }
  } catch (...) {
    while (++body < bodies_.size()) {
      try {
        bodies_[body].engine->finish(slot);
      } catch (...) {  // only the first failure is thrown
      }
    }
    throw;
  }
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
  std::ranges::fill(answers_.first_poses(slot), HitSet::kNever);
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
    if (pose != HitSet::kNever) first_poses[i] = std::min(first_poses[i], number_of(pose));
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

}  // namespace clearway
