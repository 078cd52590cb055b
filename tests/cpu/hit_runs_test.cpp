// Runs of poses, which the sweep searches as one where hundreds of poses graze a point.
#include "core/geometry/point_box.hpp"
#include "core/geometry/triangle_box.hpp"
#include "core/sweep/block_descent.hpp"
#include "core/sweep/sweep_filter.hpp"
#include "engine_scenes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A long load of few triangles that just fits between walls, with what a filter of it needs.
struct GrazingFilter {
  GrazingFilter() {
    for (int i = 0; i < 500; ++i) {
      const double off = query.radius + uniform(random, -0.01, 0.1), x = uniform(random, -1, 6);
      points.push_back(i % 2 == 0 ? Vec3{x, 0.5 + off, uniform(random, -0.3, 0.2)}
                                  : Vec3{x, uniform(random, -0.4, 0.5), 0.2 + off});
    }
  }

  Random random{23};
  std::vector<Vec3> points;
  Query query{
      surface_model(box_surface({{-3, -0.4, -0.3}, {3, 0.5, 0.2}})), slow_path(400, 1e-3), {0.2}};
  MemoryCloud cloud{std::vector<Quantum>(1), quantisation_of(1)};
  TriangleTree model{triangles_of(query.model)};
  ModelField field{model, query.radius, {}, 1};
  MotionTree motion{query.poses, model.box()};
  SweepFilterOf<Triangle> filter{query, motion, model, field, cloud};

  /// The nodes of the motion that may bring the model near the points.
  std::vector<std::uint32_t> nodes_near(std::span<const Vec3> of, double grown) {
    std::vector<std::uint32_t> nodes;
    filter.narrow(box_of(of).grown(grown), std::vector<std::uint32_t>{0}, nodes, narrowing);
    return nodes;
  }
  SweepStatistics narrowing;
};

/// Searches a point by poses alone, without runs, and returns its first pose.
std::uint32_t first_pose_by_poses(const SweepFilterOf<Triangle>& filter, const Vec3& e,
                                  const std::vector<std::uint32_t>& nodes, SweepStatistics& tests) {
  std::uint32_t best = kNoPose;
  for (const std::uint32_t index : nodes) {
    const MotionNode& node = filter.motion().nodes()[index];
    const SweepVerdict verdict = filter.ref().look(e, node, tests);
    if (verdict == SweepVerdict::kDismissed) continue;
    if (verdict == SweepVerdict::kHitAtMid) best = std::min(best, node.mid);
    if (node.count > 1) {
      filter.lower_first_pose(e, index, best, tests);
    } else if (filter.ref().collides_at(e, node)) {
      best = std::min(best, node.first);
    }
  }
  return best;
}

}  // namespace

TEST_CASE("runs of poses take a fraction of the tests that single poses do") {
  GrazingFilter made;
  const SweepFilterOf<Triangle>& filter = made.filter;
  SweepStatistics by_poses, by_runs, unused;
  std::uint64_t grazing = 0;
  for (const Vec3& e : made.points) {
    const std::vector<std::uint32_t> nodes = made.nodes_near({&e, 1}, 0.1);
    std::vector<std::uint32_t> runs;
    SweepStatistics tests;
    const std::uint32_t first_pose = first_pose_by_poses(filter, e, nodes, tests);
    filter.join_runs(filter.cost_of(tests), nodes, runs);
    if (runs.empty()) continue;
    ++grazing;
    by_poses.add(tests);
    CHECK(runs.size() < nodes.size());
    CHECK(filter.touches_runs(e, runs, by_runs) == (first_pose != kNoPose));
    CHECK(filter.first_pose_of_runs(e, runs, unused) == first_pose);
  }
  CHECK(grazing > 40);
  CHECK(8 * by_runs.point_tests < by_poses.point_tests);
}

TEST_CASE("a point that is searched in runs is counted once") {
  GrazingFilter made;
  BlockDescentOf<Triangle> descent(made.filter);
  SweepStatistics of_sets, of_first_poses;
  constexpr std::uint64_t kAll = ~std::uint64_t{0};
  std::uint64_t searched = 0;
  for (; searched + kBlockPoints <= made.points.size(); searched += kBlockPoints) {
    const auto points = std::span(made.points).subspan(searched, kBlockPoints);
    for (std::uint32_t i = 0; i < kBlockPoints; ++i) {
      for (int k = 0; k < 3; ++k) descent.points().at[k][i] = points[i][k];
    }
    const std::vector<std::uint32_t> nodes = made.nodes_near(points, 0);
    std::uint32_t first_poses[kBlockPoints];
    CHECK(descent.touches(kAll, nodes, of_sets) ==
          descent.find_first_poses(kAll, nodes, first_poses, of_first_poses));
  }
  check_equal(of_sets.points_tested, searched);
  check_equal(of_first_poses.points_tested, searched);
}
