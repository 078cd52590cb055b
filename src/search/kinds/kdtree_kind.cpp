#include "search/kinds/kdtree_kind.hpp"

#include "core/util/format.hpp"

namespace clearway {

KdTreeKind::KdTreeKind(const PackedCloud& cloud, const Query& query, const SearchOptions& options)
    : PageEngineKind({.most_slots = static_cast<std::uint32_t>(options.threads) + kSlotsAhead,
                      .threads = options.threads}),
      cloud_(cloud),
      query_(query) {}

const PoseReach& KdTreeKind::build_index(const QueryTrees& trees, std::uint64_t) {
  path_.emplace(query_, trees.motion);
  return reach_.emplace(query_, trees.motion, trees.of<Vec3>(), cloud_);
}

std::uint64_t KdTreeKind::host_bytes(const SlotLayout& layout, std::uint64_t) const {
  return layout.slots * KdTreeEngine::slot_bytes(cloud_, *path_, layout);
}

PageEngines KdTreeKind::make(const SlotLayout& layout) {
  PageEngines engines;
  engines.push_back(std::make_unique<KdTreeEngine>(cloud_, *path_, layout));
  return engines;
}

void KdTreeKind::report_search(EngineList engines, SearchReport&, const MessageLog& log) const {
  const auto& engine = dynamic_cast<const KdTreeEngine&>(*engines.front());
  log.note("pairs of a pose and a model point that were searched: " +
           format_count(engine.tested_searches()));
}

}  // namespace clearway
