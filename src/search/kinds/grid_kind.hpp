#pragma once

#include <optional>

#include "core/cloud/packed_cloud.hpp"
#include "core/grid/grid_scene.hpp"
#include "core/page/model_reach.hpp"
#include "search/kinds/page_engine_kind.hpp"

namespace clearway {

/// What the grid engine's kinds for CPU and GPU share: the scene, and how far the model reaches.
class GridKind : public PageEngineKind {
 public:
  /// cloud and query outlive it.
  GridKind(PageEngineNeeds needs, const PackedCloud& cloud, const Query& query,
           const GridOptions& scene_options)
      : PageEngineKind(std::move(needs)),
        cloud_(cloud),
        query_(query),
        scene_options_(scene_options) {}

  const PoseReach& build_index(const QueryTrees& trees, std::uint64_t most_bytes) override;
  std::uint64_t index_bytes() const override { return scene_->size_bytes(); }
  double grid_cell() const { return scene_->grid_cell(); }  ///< once there is an index

 protected:
  void log_statistics(const GridStatistics& statistics, const MessageLog& log) const;

  const PackedCloud& cloud_;
  const Query& query_;
  std::optional<GridScene> scene_;

 private:
  GridOptions scene_options_;
  std::optional<ModelReach> reach_;
};

class CpuGridKind final : public GridKind {
 public:
  /// options.threads is not 0.
  CpuGridKind(const PackedCloud& cloud, const Query& query, const SearchOptions& options,
              const GridOptions& scene_options = {});

  std::uint64_t host_bytes(const SlotLayout& layout, std::uint64_t most_poses) const override;
  PageEngines make(const SlotLayout& layout) override;
  void report_search(EngineList engines, SearchReport& report,
                     const MessageLog& log) const override;
};

}  // namespace clearway
