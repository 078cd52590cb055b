#include "support/engines/engines.hpp"

#include <algorithm>
#include <utility>

#include "core/query/search_result.hpp"
#include "cpu/sweep_engine.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/engines/brute_force.hpp"
#include "support/engines/check_profile.hpp"
#include "support/engines/grid_runs.hpp"
#include "support/engines/host_sweep.hpp"

namespace clearway {
using namespace test;
namespace {

SearchResult kdtree(const PackedCloud& cloud, const Query& query, int threads) {
  return {run_kdtree(cloud, query, {.threads = threads}), ClearanceSet()};
}

SearchResult sweep(const PackedCloud& cloud, const Query& query, int threads, double tolerance) {
  return run_sweep(cloud, query, threads, tolerance,
                   []<typename Element>(const SweepFilterOf<Element>& filter, const PackedCloud& of,
                                        const SlotLayout& layout) {
                     const bool in_place = layout.cells % 2 == 0;
                     return std::make_unique<SweepEngineOf<Element>>(of, filter, layout, in_place);
                   });
}

/// Runs the kernels' bodies of the CUDA sweep engine as loops, with lists of open work from ample
/// to none.
SearchResult sweep_as_on_cuda(const PackedCloud& cloud, const Query& query, int threads,
                              double tolerance) {
  return run_sweep(cloud, query, threads, tolerance,
                   []<typename Element>(const SweepFilterOf<Element>& filter, const PackedCloud& of,
                                        const SlotLayout& layout) {
                     const std::uint32_t entries = layout.slots % 3 == 0   ? 0
                                                   : layout.slots % 3 == 1 ? 50
                                                                           : 100'000;
                     return std::make_unique<HostSweepOf<Element>>(of, filter.ref(), layout,
                                                                   entries);
                   });
}

SearchResult grid(const PackedCloud& cloud, const Query& query, int threads) {
  return {run_grid(cloud, query, {.threads = threads}), ClearanceSet()};
}

std::vector<Engine> under_test{
    {"kdtree", kdtree, false},
    {"sweep", run_exactly<sweep>, true, sweep},
    {"sweep as on CUDA", run_exactly<sweep_as_on_cuda>, true, sweep_as_on_cuda},
    {"grid", grid, false}};

/// The number of threads of the next run: three for every fifth run, otherwise one, because in
/// scenes this small threads mostly wait for each other. The runs of a scene are no multiple of
/// five, so every engine and kind of query has its turn.
int next_threads() {
  static int runs = 0;
  return ++runs % 5 == 0 ? 3 : 1;
}

/// The expected first poses by brute force, at poses and between them.
struct Expected {
  Expected(const std::vector<Vec3>& positions, Query query) {
    query.between_poses = false;
    at_poses = brute_force_first_poses(positions, query);
    if (query.model.is_surface()) return;
    query.between_poses = true;
    between_poses = brute_force_first_poses(positions, query);
  }

  std::vector<std::uint32_t> at_poses, between_poses;
};

std::uint64_t check_results(const MemoryCloud& cloud, const std::vector<std::uint32_t>& expected,
                            Query query) {
  std::uint64_t colliding = 0;
  for (const std::uint32_t pose : expected) colliding += pose != kNoPose;
  for (const Engine& engine : engines()) {
    const bool needs_all = query.between_poses || query.floor || query.model.is_surface();
    if (needs_all && !engine.finds_all) continue;
    for (const bool first_pose : {false, true}) {
      if (first_pose && !engine.finds_all) continue;
      query.first_pose = first_pose;
      const int threads = next_threads();
      const HitSet hits = engine.run(cloud, query, threads).hits;
      CAPTURE(engine.name, threads, first_pose, query.between_poses, cloud.cell_points(),
              cloud.cells().size());
      std::uint64_t wrong = 0;
      for (std::uint64_t slot = 0; slot < cloud.entry_count(); ++slot) {
        if (!cloud.is_used(slot)) {
          wrong += hits.contains(slot);
          continue;
        }
        const std::uint32_t pose = expected[cloud.source(slot)];
        wrong += hits.contains(slot) != (pose != kNoPose);
        if (first_pose) wrong += hits.first_pose(slot) != pose;
      }
      check_equal(wrong, 0);
      CHECK(hits.count() == colliding);
    }
  }
  return colliding;
}

using Oracle = std::vector<Clearance>;

/// Checks every clearance and every hit of one engine, with and without first poses.
std::uint64_t check_clearances(const Engine& engine, const MemoryCloud& cloud, const Oracle& least,
                               const std::vector<std::uint32_t>& first_poses, const Query& query) {
  const double limit = query.clearance * query.clearance;
  const int threads = next_threads();
  const SearchResult answer = engine.run(cloud, query, threads);
  CAPTURE(engine.name, threads, query.clearance, query.radius, query.first_pose,
          cloud.cell_points());
  std::uint64_t wrong = 0, wrong_hits = 0, found = 0;
  for (std::uint64_t slot = 0; slot < cloud.entry_count(); ++slot) {
    Clearance expected;
    std::uint32_t pose = kNoPose;
    if (cloud.is_used(slot)) {
      const Clearance& oracle = least[cloud.source(slot)];
      if (oracle.squared < limit) expected = oracle;
      pose = first_poses[cloud.source(slot)];
    }
    found += expected.found();
    wrong += answer.clearances.at(slot) != expected;
    wrong_hits += answer.hits.contains(slot) != (pose != kNoPose);
    if (query.first_pose) wrong_hits += answer.hits.first_pose(slot) != pose;
  }
  check_equal(wrong, 0);
  check_equal(wrong_hits, 0);
  return found;
}

std::uint64_t check_clearances(const MemoryCloud& cloud, const Oracle& least,
                               const std::vector<std::uint32_t>& first_poses, const Query& query) {
  std::uint64_t found = 0;
  for (const Engine& engine : engines()) {
    if (engine.finds_all) found = check_clearances(engine, cloud, least, first_poses, query);
  }
  return found;
}

Query with_clearance(Query query, double clearance, bool first_pose) {
  query.clearance = clearance;
  query.first_pose = first_pose;
  return query;
}

std::uint64_t check_packed(const MemoryCloud& cloud, const Expected& expected, Query query) {
  query.between_poses = false;
  const std::uint64_t colliding = check_results(cloud, expected.at_poses, query);
  if (query.model.is_surface()) return colliding;
  query.between_poses = true;
  CHECK(check_results(cloud, expected.between_poses, query) >= colliding);
  return colliding;
}

/// Which points a query ignores, by the definition of its classes and boxes.
std::vector<bool> ignored_by(const Query& query, const std::vector<Vec3>& positions,
                             std::span<const std::uint8_t> classes) {
  std::vector<bool> ignored;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3& p = positions[i];
    const bool by_class = std::ranges::count(query.ignore_classes, classes[i]) > 0;
    const bool by_box = std::ranges::any_of(query.ignore_boxes, [&p](const Box& box) {
      return p.x >= box.lo.x && p.x <= box.hi.x && p.y >= box.lo.y && p.y <= box.hi.y &&
             p.z >= box.lo.z && p.z <= box.hi.z;
    });
    ignored.push_back(by_class || by_box);
  }
  return ignored;
}

/// The nearest point of every pose by brute force, as if the ignored points were not there.
std::vector<NearestPoint> nearest_of_searched(const std::vector<Vec3>& positions,
                                              const std::vector<bool>& ignored,
                                              const Query& query) {
  std::vector<Vec3> searched;
  std::vector<std::uint64_t> sources;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (ignored[i]) continue;
    searched.push_back(positions[i]);
    sources.push_back(i);
  }
  std::vector<NearestPoint> nearest = nearest_points(searched, query);
  for (NearestPoint& point : nearest) {
    if (point.source < sources.size()) point.source = sources[point.source];
  }
  return nearest;
}

}  // namespace

std::span<const Engine> engines() { return under_test; }

void test_only(std::vector<Engine> engines) { under_test = std::move(engines); }

std::vector<std::uint32_t> check_between_poses(std::span<const Quantum> points,
                                               const Quantisation& quantisation, Query query) {
  query.between_poses = true;
  const auto expected = brute_force_first_poses(positions_of(points, quantisation), query);
  check_results(MemoryCloud(points, quantisation, {128, 0}), expected, query);
  return expected;
}

std::uint64_t check_engines(std::span<const Quantum> points, const Quantisation& quantisation,
                            const Query& query, const MemoryCloudOptions& packing) {
  const auto environment = positions_of(points, quantisation);
  const Expected expected(environment, query);
  const MemoryCloud cloud(points, quantisation, packing);
  check_clearances(cloud, brute_force_clearances(environment, query), expected.at_poses,
                   with_clearance(query, 2.5 * query.radius, points.size() % 2 == 0));
  check_profile(cloud, nearest_points(environment, query), with_profile(query, points.size()));
  return check_packed(cloud, expected, query);
}

std::uint64_t check_engines(std::span<const Quantum> points, const Quantisation& quantisation,
                            const Query& query) {
  return check_engines(points, std::vector<std::uint8_t>(points.size()), quantisation, query);
}

std::uint64_t check_engines(std::span<const Quantum> points, std::span<const std::uint8_t> classes,
                            const Quantisation& quantisation, const Query& query) {
  const auto environment = positions_of(points, quantisation);
  const std::vector<bool> ignored = ignored_by(query, environment, classes);
  Expected expected(environment, query);
  Oracle least = brute_force_clearances(environment, query);
  for (std::size_t i = 0; i < ignored.size(); ++i) {
    if (!ignored[i]) continue;
    expected.at_poses[i] = kNoPose;
    if (!query.model.is_surface()) expected.between_poses[i] = kNoPose;
    least[i] = {};
  }
  const std::vector<NearestPoint> nearest = nearest_of_searched(environment, ignored, query);
  std::uint64_t colliding = 0;
  double of_radius = 0.4;
  bool first_pose = false;
  std::size_t variant = points.size();
  for (const MemoryCloudOptions& packing :
       {MemoryCloudOptions{64, 0}, MemoryCloudOptions{1000, 0}, MemoryCloudOptions{65536, 0},
        MemoryCloudOptions{128, 500}}) {
    const MemoryCloud cloud(points, classes, quantisation, packing);
    colliding = check_packed(cloud, expected, query);
    check_clearances(cloud, least, expected.at_poses,
                     with_clearance(query, of_radius * query.radius, first_pose));
    check_profile(cloud, nearest, with_profile(query, variant++));
    first_pose = !first_pose;
    of_radius *= 2.5;
  }
  return colliding;
}

std::uint64_t check_clearances(std::span<const Quantum> points, const Quantisation& quantisation,
                               const Query& query) {
  const auto environment = positions_of(points, quantisation);
  return check_clearances(MemoryCloud(points, quantisation, {256, 0}),
                          brute_force_clearances(environment, query),
                          brute_force_first_poses(environment, query), query);
}

}  // namespace clearway
