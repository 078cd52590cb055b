#pragma once

#include <cstdint>
#include <vector>

#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "core/grid/grid_view.hpp"
#include "core/trajectory/motion_tree.hpp"

namespace clearway {

enum class GridPrecision {
  kExact,  ///< floats filter, the predicate decides
  kFloat,  ///< floats decide, in the scene's own coordinates; only for comparison
};

struct GridOptions {
  double grid_cell = 0;  ///< metres; 0: chosen. Coarser for cells that need it
  GridPrecision precision = GridPrecision::kExact;
};

/// Model, trajectory and environment as the grid engine needs them; the same for every page.
class GridScene {
 public:
  /// query: its model and poses must outlive this object, as must `motion`. Of the cloud no points
  /// are read.
  GridScene(const Query& query, const MotionTree& motion, const PackedCloud& cloud,
            const GridOptions& options = {});

  const ModelGroups& model() const { return model_; }
  std::span<const Pose> poses() const { return motion_.poses(); }
  std::span<const PoseBound> bounds() const { return bounds_; }
  std::span<const GridNode> nodes() const { return nodes_; }
  std::span<const std::uint32_t> runs() const { return runs_; }
  double grid_cell() const { return grid_cell_; }  ///< side of the grid cells, metres
  double group_radius() const { return group_radius_; }

  /// Calls visit(member of GridSceneView, values) for each array that the views refer to.
  template <typename Visit>
  void for_each_array(Visit visit) const {
    visit(&GridSceneView::points, model_.points());
    visit(&GridSceneView::groups, model_.groups());
    visit(&GridSceneView::parts, model_.parts());
    visit(&GridSceneView::poses, poses());
    visit(&GridSceneView::bounds, bounds());
    visit(&GridSceneView::nodes, nodes());
    visit(&GridSceneView::runs, runs());
  }

  /// Size of all these arrays, bytes.
  std::uint64_t size_bytes() const {
    std::uint64_t bytes = 0;
    for_each_array([&](auto, auto values) { bytes += values.size_bytes(); });
    return bytes;
  }

  /// A view of the arrays in the host's memory.
  const GridSceneView& view() const { return view_; }

 private:
  void add_nodes();
  void choose_group_radius();
  double float_search_radius(const PackedCloud& cloud) const;

  const MotionTree& motion_;
  ModelGroups model_;
  std::vector<PoseBound> bounds_;
  std::vector<GridNode> nodes_;
  std::vector<std::uint32_t> runs_;
  double grid_cell_;
  double group_radius_ = 0;
  GridSceneView view_{};
};

}  // namespace clearway
