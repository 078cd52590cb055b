#pragma once

#include <algorithm>
#include <vector>

#include "core/sweep/field/model_field.hpp"
#include "core/sweep/sweep_filter.hpp"
#include "stream/plan.hpp"
#include "support/memory_cloud.hpp"
#include "support/scenes.hpp"

namespace clearway::test {

inline const Quantisation kTenths{{1e-4, 1e-4, 1e-4}, {0, 0, 0}};

/// A small cloud, a model on a path through it, and the plan of the query.
class PlannedScene {
 public:
  explicit PlannedScene(const MemoryCloudOptions& packing = {256, 2000}, std::size_t points = 9000,
                        std::size_t pose_count = 80, bool first_pose = true, double clearance = 0,
                        double profile = 0)
      : cloud_points(quantise(random_points(random_, kRoom, points), kTenths)),
        model(random_points(random_, {{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}}, 60)),
        poses(smooth_path(random_, kWay, pose_count)),
        cloud(cloud_points, kTenths, packing),
        query{model, poses, {0.1, first_pose, false, clearance, profile}},
        tree(model),
        field(tree, query.radius, {.reach = std::max(clearance, profile)}, 1),
        motion(poses, tree.box()),
        filter(query, motion, tree, field, cloud),
        cells(plan(cloud, filter)) {}

 private:
  static constexpr Box kRoom{{0, 0, 0}, {12, 6, 3}};
  static constexpr Box kWay{{1, 1, 1}, {8, 5, 2}};  // one end of the room stays out of reach
  Random random_{7};

 public:
  std::vector<Quantum> cloud_points;
  std::vector<Vec3> model;
  std::vector<Pose> poses;
  MemoryCloud cloud;
  Query query;
  ModelTree tree;
  ModelField field;
  MotionTree motion;
  SweepFilter filter;
  std::vector<PlannedCell> cells;
};

/// Plans every cell of a cloud with a few nodes each, whether or not they reach it.
inline std::vector<PlannedCell> every_cell(const PackedCloud& cloud) {
  std::vector<PlannedCell> cells;
  for (std::uint32_t cell = 0; cell < cloud.cells().size(); ++cell) {
    cells.push_back({cell, std::vector<std::uint32_t>(1 + cell % 7, 3 * cell)});
  }
  return cells;
}

}  // namespace clearway::test
