#pragma once

#include <optional>

#include "core/cloud/packed_cloud.hpp"
#include "core/grid/grid_scene.hpp"
#include "core/page/model_reach.hpp"
#include "core/util/format.hpp"
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

  const PoseReach& build_index(const QueryTrees& trees, std::uint64_t) override {
    scene_.emplace(query_, trees.motion, cloud_, scene_options_);
    return reach_.emplace(query_, trees.motion, trees.of<Vec3>(), cloud_);
  }
  std::uint64_t index_bytes() const override { return scene_->size_bytes(); }
  double grid_cell() const { return scene_->grid_cell(); }  ///< once there is an index

 protected:
  void log_statistics(const GridStatistics& s, const MessageLog& log) const {
    log.note("grid cell " + format_brief(grid_cell()) + " m; tests: " +
             format_count(s.sphere_tests) + " of spheres, " + format_count(s.searches) + " of " +
             format_count(s.points_moved) + " moved points searched, " +
             format_count(s.point_tests) + " in float, " + format_count(s.exact_tests) + " exact");
  }

  const PackedCloud& cloud_;
  const Query& query_;
  std::optional<GridScene> scene_;

 private:
  GridOptions scene_options_;
  std::optional<ModelReach> reach_;
};

}  // namespace clearway
