#include "support/engines/engines.hpp"

#include <cmath>
#include <limits>

#include "core/geometry/predicate.hpp"
#include "cpu/sweep_engine.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/engines/grid_runs.hpp"
#include "support/engines/host_sweep.hpp"
#include "support/engines/sweep_runs.hpp"

namespace clearway {
using namespace test;
namespace {

SearchResult kdtree(const PackedCloud& cloud, const Query& query, int threads) {
  return run_kdtree(cloud, query, {.threads = threads});
}

SearchResult grid(const PackedCloud& cloud, const Query& query, int threads) {
  return run_grid(cloud, query, {.threads = threads});
}

SearchResult sweep(const PackedCloud& cloud, const Query& query, int threads) {
  return run_sweep(cloud, query, threads,
                   []<typename Element>(const SweepFilterOf<Element>& filter, const PackedCloud& of,
                                        const SlotLayout& layout) {
                     const bool in_place = layout.cells % 2 == 0;
                     return std::make_unique<SweepEngineOf<Element>>(of, filter, layout, in_place);
                   });
}

/// Runs the kernels' bodies of the CUDA sweep engine as loops, with lists of open work from ample
/// to none.
SearchResult sweep_as_on_cuda(const PackedCloud& cloud, const Query& query, int threads) {
  return run_sweep(cloud, query, threads,
                   []<typename Element>(const SweepFilterOf<Element>& filter, const PackedCloud& of,
                                        const SlotLayout& layout) {
                     const std::uint32_t entries = layout.slots % 3 == 0   ? 0
                                                   : layout.slots % 3 == 1 ? 50
                                                                           : 100'000;
                     return std::make_unique<HostSweepOf<Element>>(of, filter.ref(), layout,
                                                                   entries);
                   });
}

/// Which points a query ignores, by the definition of its classes and boxes.
bool is_ignored(const Query& query, const Vec3& p, std::uint8_t of_class) {
  return std::ranges::count(query.ignore_classes, of_class) > 0 ||
         std::ranges::any_of(query.ignore_boxes, [&p](const Box& box) {
           return p.x >= box.lo.x && p.x <= box.hi.x && p.y >= box.lo.y && p.y <= box.hi.y &&
                  p.z >= box.lo.z && p.z <= box.hi.z;
         });
}

std::vector<std::uint8_t> classes_of(const EngineScene& scene) {
  return scene.classes.empty() ? std::vector<std::uint8_t>(scene.points.size()) : scene.classes;
}

/// The values of searched points, each at the place of its source.
template <typename Value>
std::vector<Value> spread(const std::vector<Value>& searched,
                          const std::vector<std::uint64_t>& sources, std::size_t points,
                          const Value& none) {
  std::vector<Value> all(points, none);
  for (std::size_t i = 0; i < searched.size(); ++i) all[sources[i]] = searched[i];
  return all;
}

/// The number of threads of the next run: three for every fifth run, otherwise one, because in
/// scenes this small threads mostly wait for each other. The runs of a scene are no multiple of
/// five, so every engine and kind of query has its turn.
int next_threads() {
  static int runs = 0;
  return ++runs % 5 == 0 ? 3 : 1;
}

/// The questions about a scene for one way to pack its points. variant: chooses the distances.
std::vector<Query> questions(const EngineScene& scene, double reach, std::size_t variant) {
  constexpr double kOfRadius[] = {0.3, 1, 1.7, 6, 40};
  std::vector<Query> questions;
  const auto add = [&](bool first_pose, bool between_poses, double clearance, double profile) {
    Query& query = questions.emplace_back(scene.query);
    query.first_pose = first_pose;
    query.between_poses = between_poses;
    query.clearance = clearance;
    query.profile = profile;
  };
  for (const bool first_pose : {false, true}) {
    add(first_pose, false, 0, 0);
    if (!scene.query.model.is_surface()) add(first_pose, true, 0, 0);
  }
  const double radius = scene.query.radius;
  const bool first_pose = variant % 2 == 0;
  add(first_pose, false, kOfRadius[(variant + 2) % 5] * radius, 0);
  add(first_pose, false, variant % 3 == 0 ? 0.8 * radius : 0, kOfRadius[variant % 5] * radius);
  if (reach > 0) add(!first_pose, false, reach, variant % 3 == 0 ? 0 : reach);
  return questions;
}

void check_answers(const MemoryCloud& cloud, const Expected& expected, const Query& query) {
  const bool needs_all = query.between_poses || query.floor || query.first_pose ||
                         query.clearance > 0 || query.profile > 0 || query.model.is_surface();
  for (const Engine& engine : engines()) {
    if (needs_all && !engine.finds_all) continue;
    const int threads = next_threads();
    CAPTURE(engine.name, threads, query.first_pose, query.between_poses, query.clearance,
            query.profile, query.radius, cloud.cell_points(), cloud.cells().size());
    check_equal(expected.wrong(engine.run(cloud, query, threads), cloud, query), 0);
  }
}

}  // namespace

std::vector<Engine>& engines() {
  static std::vector<Engine> engines{{"kdtree", kdtree, false},
                                     {"sweep", sweep, true},
                                     {"sweep as on CUDA", sweep_as_on_cuda, true},
                                     {"grid", grid, false}};
  return engines;
}

Expected::Expected(const EngineScene& scene) : query_(scene.query), points_(scene.points.size()) {
  const std::vector<Vec3> positions = positions_of(scene.points, scene.quantisation);
  const std::vector<std::uint8_t> classes = classes_of(scene);
  for (std::size_t i = 0; i < points_; ++i) {
    if (is_ignored(query_, positions[i], classes[i])) continue;
    searched_.push_back(positions[i]);
    sources_.push_back(i);
  }
}

const std::vector<std::uint32_t>& Expected::first_poses(bool between_poses) const {
  auto& first = first_poses_[between_poses ? 1 : 0];
  if (!first) {
    Query query = query_;
    query.between_poses = between_poses;
    first = spread(brute_force_first_poses(searched_, query), sources_, points_, kNoPose);
  }
  return *first;
}

const std::vector<Clearance>& Expected::clearances() const {
  if (!clearances_) {
    clearances_ = spread(brute_force_clearances(searched_, query_), sources_, points_, {});
  }
  return *clearances_;
}

const std::vector<NearestPoint>& Expected::nearest() const {
  if (!nearest_) {
    Query query = query_;
    query.profile = 1e200;  // its square is infinite
    nearest_ = brute_force_profile(searched_, query);
    for (NearestPoint& point : *nearest_) {
      if (point.source < sources_.size()) point.source = sources_[point.source];
    }
  }
  return *nearest_;
}

std::uint64_t Expected::colliding(bool between_poses) const {
  const auto& first = first_poses(between_poses);
  return first.size() - static_cast<std::uint64_t>(std::ranges::count(first, kNoPose));
}

std::uint64_t Expected::wrong(const SearchResult& answer, const MemoryCloud& cloud,
                              const Query& query) const {
  std::uint64_t wrong = 0, with_point = 0;
  for (std::uint64_t entry = 0; entry < cloud.entry_count(); ++entry) {
    std::uint32_t pose = kNoPose;
    Clearance least;
    if (cloud.is_used(entry)) {
      const std::uint64_t source = cloud.source(entry);
      pose = first_poses(query.between_poses)[source];
      if (query.clearance > 0) least = clearances()[source];
      if (!(least.squared < query.clearance * query.clearance)) least = {};
    }
    wrong += answer.hits.contains(entry) != (pose != kNoPose);
    if (query.first_pose) wrong += answer.hits.first_pose(entry) != pose;
    if (query.clearance > 0) wrong += answer.clearances.at(entry) != least;
  }
  if (!(query.profile > 0)) return wrong;
  const double limit = rounded_product(query.profile, query.profile);
  REQUIRE(answer.profile.poses() == nearest().size());
  for (std::size_t pose = 0; pose < nearest().size(); ++pose) {
    const ProfilePoint point = answer.profile.at(pose);
    if (!(nearest()[pose].squared < limit)) {
      wrong += point.found();
      continue;
    }
    ++with_point;
    wrong += point.squared != nearest()[pose].squared || point.source != nearest()[pose].source ||
             !cloud.is_used(point.entry) || cloud.source(point.entry) != point.source;
  }
  return wrong + (answer.profile.count() != with_point);
}

Expected check_engines(const EngineScene& scene, const Asked& asked) {
  Expected expected(scene);
  std::size_t variant = scene.points.size();
  for (const MemoryCloudOptions& packing : asked.packings) {
    const MemoryCloud cloud(scene.points, classes_of(scene), scene.quantisation, packing);
    for (const Query& query : questions(scene, asked.reach, variant++)) {
      check_answers(cloud, expected, query);
    }
  }
  return expected;
}

}  // namespace clearway
