#include "core/grid/grid_scene.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/geometry/rigid.hpp"
#include "core/grid/grid_size.hpp"

namespace clearway {
namespace {

/// Bits of each of a cell's two occupancies for each point of the cell.
constexpr std::uint32_t kOccupancyBits = 16;

}  // namespace

GridScene::GridScene(const Query& query, const MotionTree& motion, const PackedCloud& cloud,
                     const GridOptions& options)
    : motion_(motion),
      model_(query.model.vertices),
      bounds_(pose_bounds(query.poses, model_.box())),
      grid_cell_(options.grid_cell > 0 ? options.grid_cell
                                       : cheapest_grid_cell(query.radius, surface_density(cloud))) {
  add_nodes();
  for_each_array([&](auto member, auto values) { view_.*member = values.data(); });
  view_.quantisation = cloud.quantisation();
  view_.point_count = static_cast<std::uint32_t>(model_.points().size());
  view_.group_count = static_cast<std::uint32_t>(model_.groups().size());
  view_.part_count = static_cast<std::uint32_t>(model_.parts().size());
  view_.slots = cloud.cell_entries();
  view_.bucket_count = std::max(64U, std::bit_ceil(cloud.cell_entries()));
  view_.word_count = std::bit_ceil(std::max(64U, cloud.cell_entries() * kOccupancyBits / 64));
  view_.radius = view_.search_radius = query.radius;
  view_.float_alone = options.precision == GridPrecision::kFloat;
  if (view_.float_alone) view_.search_radius = float_search_radius(cloud);
  choose_group_radius();
}

/// Copies the motion nodes and finds the runs. Nodes are in preorder, so their runs come in the
/// order of their poses.
void GridScene::add_nodes() {
  const std::span<const MotionNode> motion = motion_.nodes();
  nodes_.reserve(motion.size());
  std::size_t below_run = 0;  // nodes before this one belong to the last run
  for (std::size_t i = 0; i < motion.size(); ++i) {
    const MotionNode& n = motion[i];
    const auto first_run = static_cast<std::uint32_t>(runs_.size());
    nodes_.push_back({n.first, n.count, n.mid, first_run, 1, n.delta + bounds_[n.mid].spread});
    if (i < below_run || n.count > kRunPoses) continue;
    runs_.push_back(static_cast<std::uint32_t>(i));
    below_run = i + 2 * std::size_t{n.count} - 1;
  }
  for (GridNode& node : nodes_) {
    if (node.count <= kRunPoses) continue;
    const auto end = std::lower_bound(
        runs_.begin(), runs_.end(), node.first + node.count,
        [&](std::uint32_t run, std::uint32_t pose) { return nodes_[run].first < pose; });
    node.runs = static_cast<std::uint32_t>(end - runs_.begin()) - node.first_run;
  }
}

/// Chooses the radius so that nine of ten groups find their bit in the group occupancy at any pose.
void GridScene::choose_group_radius() {
  std::vector<double> radii;
  for (const GridSphere& group : model_.groups()) radii.push_back(group.radius);
  if (radii.empty() || bounds_.empty()) return;
  const auto at = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() * 9 / 10);
  std::nth_element(radii.begin(), at, radii.end());
  PoseBound greatest{0, 0};
  for (const PoseBound& bound : bounds_) {
    greatest.stretch = std::max(greatest.stretch, bound.stretch);
    greatest.spread = std::max(greatest.spread, bound.spread);
  }
  group_radius_ = (view_.search_radius + greatest.stretch * *at + greatest.spread) * (1 + 1e-12);
}

/// The distance beyond which a pair is not a hit if floats decide (docs/design/numerics.md, "Floats
/// alone").
double GridScene::float_search_radius(const PackedCloud& cloud) const {
  double largest = 0;
  if (!cloud.tree().empty()) {
    const Vec3 reach = reach_of(position_box(cloud.quantisation(), cloud.tree()[0].box));
    largest = std::max({reach.x, reach.y, reach.z});
  }
  const Vec3 reach = reach_of(model_.box());
  double moved = 0;
  for (const Pose& pose : poses()) {
    for (int k = 0; k < 3; ++k) {
      const double* row = pose.rotation + 3 * k;
      moved = std::max(moved, std::abs(row[0]) * reach.x + std::abs(row[1]) * reach.y +
                                  std::abs(row[2]) * reach.z + std::abs(pose.translation[k]));
    }
  }
  return view_.radius * (1 + 0x1p-19) + 0x1p-20 * (largest + moved) + 1e-20;
}

}  // namespace clearway
