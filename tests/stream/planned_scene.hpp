#pragma once

#include <algorithm>
#include <atomic>
#include <functional>
#include <vector>

#include "core/sweep/field/model_field.hpp"
#include "core/sweep/sweep_filter.hpp"
#include "stream/plan.hpp"
#include "support/engines/engines.hpp"
#include "support/scenes.hpp"

namespace clearway::test {

inline const Quantisation kTenths{{1e-4, 1e-4, 1e-4}, {0, 0, 0}};

/// A cloud that calls a test's function before each read.
class TestCloud final : public MemoryCloud {
 public:
  using MemoryCloud::MemoryCloud;
  std::array<PackedChunk<std::int32_t>, 3> read_packed(std::uint32_t cell,
                                                       std::span<std::byte> to) const override {
    const std::uint32_t read = reads++;
    if (before_read) before_read(read);
    return MemoryCloud::read_packed(cell, to);
  }

  mutable std::function<void(std::uint32_t)> before_read;
  mutable std::atomic<std::uint32_t> reads{0};
};

/// A small cloud, a model on a path through it, and the plan of the query.
class PlannedScene {
 public:
  explicit PlannedScene(const MemoryCloudOptions& packing = {256, 2000}, std::size_t points = 9000,
                        std::size_t pose_count = 80, bool first_pose = true, double clearance = 0,
                        double profile = 0)
      : scene_{quantise(random_points(random_, kRoom, points), kTenths),
               kTenths,
               {random_points(random_, {{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}}, 60),
                smooth_path(random_, kWay, pose_count),
                {0.1, first_pose, false, clearance, profile}}},
        query(scene_.query),
        expected(scene_),
        cloud(scene_.points, kTenths, packing),
        tree(query.model.vertices),
        field(tree, query.radius, {.reach = std::max(clearance, profile)}, 1),
        motion(query.poses, tree.box()),
        filter(query, motion, tree, field, cloud),
        cells(plan(cloud, filter)) {}

  /// The number of points and poses for which the answer is wrong.
  std::uint64_t wrong(const SearchResult& answer) const {
    return expected.wrong(answer, cloud, query);
  }

 private:
  static constexpr Box kRoom{{0, 0, 0}, {12, 6, 3}};
  static constexpr Box kWay{{1, 1, 1}, {8, 5, 2}};  // one end of the room stays out of reach
  Random random_{7};
  EngineScene scene_;

 public:
  const Query& query;
  Expected expected;
  TestCloud cloud;
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
