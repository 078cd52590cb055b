#include "search/kinds/cpu_kind.hpp"

#include "core/page/model_reach.hpp"
#include "core/util/format.hpp"
#include "cpu/grid_cpu_engine.hpp"
#include "cpu/kdtree_engine.hpp"
#include "search/kinds/grid_kind.hpp"
#include "search/kinds/sweep_kind.hpp"

namespace clearway {
namespace {

class CpuGridKind final : public GridKind {
 public:
  using GridKind::GridKind;

  std::uint64_t host_bytes(const SlotLayout& layout, std::uint64_t) const override {
    return layout.slots * GridCpuEngine::slot_bytes(*scene_, layout);
  }
  PageEngines make(const SlotLayout& layout) override {
    return only(std::make_unique<GridCpuEngine>(*scene_, layout));
  }
  void report_search(EngineList engines, SearchReport&, const MessageLog& log) const override {
    log_statistics(dynamic_cast<const GridCpuEngine&>(*engines.front()).statistics(), log);
  }
};

class KdTreeKind final : public PageEngineKind {
 public:
  KdTreeKind(PageEngineNeeds needs, const PackedCloud& cloud, const Query& query)
      : PageEngineKind(std::move(needs)), cloud_(cloud), query_(query) {}

  const PoseReach& build_index(const QueryTrees& trees, std::uint64_t) override {
    path_.emplace(query_, trees.motion);
    return reach_.emplace(query_, trees.motion, trees.of<Vec3>(), cloud_);
  }
  std::uint64_t index_bytes() const override { return path_->allocated_bytes(); }
  std::uint64_t host_bytes(const SlotLayout& layout, std::uint64_t) const override {
    return layout.slots * KdTreeEngine::slot_bytes(cloud_, *path_, layout);
  }
  PageEngines make(const SlotLayout& layout) override {
    return only(std::make_unique<KdTreeEngine>(cloud_, *path_, layout));
  }
  void report_search(EngineList engines, SearchReport&, const MessageLog& log) const override {
    const auto& engine = dynamic_cast<const KdTreeEngine&>(*engines.front());
    log.note("pairs of a pose and a model point that were searched: " +
             format_count(engine.tested_searches()));
  }

 private:
  const PackedCloud& cloud_;
  const Query& query_;
  std::optional<SpheresOnPath> path_;
  std::optional<ModelReach> reach_;
};

}  // namespace

std::unique_ptr<PageEngineKind> cpu_kind(const PackedCloud& cloud, const Query& query,
                                         const SearchOptions& options,
                                         const EngineSettings& settings) {
  if (options.engine == Engine::kGrid) {
    return std::make_unique<CpuGridKind>(cpu_needs(options), cloud, query, settings.grid);
  }
  if (options.engine == Engine::kKdtree) {
    return std::make_unique<KdTreeKind>(cpu_needs(options), cloud, query);
  }
  return for_element_of(query.model, [&]<typename Element>() -> std::unique_ptr<PageEngineKind> {
    return std::make_unique<CpuSweepKindOf<Element>>(cloud, query, options, settings);
  });
}

}  // namespace clearway
