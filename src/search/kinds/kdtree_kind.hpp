#pragma once

#include <optional>

#include "core/page/model_reach.hpp"
#include "cpu/kdtree_engine.hpp"
#include "search/kinds/page_engine_kind.hpp"

namespace clearway {

class KdTreeKind final : public PageEngineKind {
 public:
  /// options.threads is not 0. cloud and query outlive it.
  KdTreeKind(const PackedCloud& cloud, const Query& query, const SearchOptions& options);

  const PoseReach& build_index(const QueryTrees& trees, std::uint64_t most_bytes) override;
  std::uint64_t index_bytes() const override { return path_->allocated_bytes(); }
  std::uint64_t host_bytes(const SlotLayout& layout, std::uint64_t most_poses) const override;
  PageEngines make(const SlotLayout& layout) override;
  void report_search(EngineList engines, SearchReport& report,
                     const MessageLog& log) const override;

 private:
  const PackedCloud& cloud_;
  const Query& query_;
  std::optional<SpheresOnPath> path_;
  std::optional<ModelReach> reach_;
};

}  // namespace clearway
