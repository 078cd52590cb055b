#include "cpu/brute_force.hpp"

#include <algorithm>

#include "core/geometry/predicate.hpp"
#include "core/query/hit_set.hpp"

namespace clearway {
namespace {

constexpr std::size_t kPairsWorthThreads = 1'000'000;

std::vector<Vec3> moved_model(const Query& query, std::size_t pose) {
  std::vector<Vec3> moved;
  moved.reserve(query.model.size());
  for (const Vec3& m : query.model) moved.push_back(transform(query.poses[pose], m));
  return moved;
}

bool touched(const Vec3& e, const std::vector<Vec3>& moved, double radius) {
  for (const Vec3& m : moved) {
    if (collides(e, m, radius)) return true;
  }
  return false;
}

/// The first pose of `e` as the segments from pose `i` to the next one give it, or kNever.
std::uint32_t touching_pose(const Vec3& e, std::uint32_t i, const std::vector<Vec3>& from,
                            const std::vector<Vec3>& to, double radius) {
  if (touched(e, from, radius)) return i;
  for (std::size_t m = 0; m < to.size(); ++m) {
    if (collides_inside(e, from[m], to[m], radius)) return i;
  }
  return touched(e, to, radius) ? i + 1 : HitSet::kNever;
}

}  // namespace

std::vector<std::uint32_t> brute_force_first_poses(std::span<const Vec3> environment,
                                                   const Query& query) {
  std::vector<std::uint32_t> first(environment.size(), HitSet::kNever);
  const bool worth_threads = environment.size() * query.model.size() > kPairsWorthThreads;
  for (std::uint32_t i = 0; i < query.poses.size(); ++i) {
    const bool moves_on = query.between_poses && i + 1 < query.poses.size();
    const std::vector<Vec3> from = moved_model(query, i);
    const std::vector<Vec3> to = moves_on ? moved_model(query, i + 1) : std::vector<Vec3>();
#pragma omp parallel for schedule(static) if (worth_threads)
    for (std::size_t e = 0; e < environment.size(); ++e) {
      if (first[e] <= i) continue;
      const std::uint32_t pose = touching_pose(environment[e], i, from, to, query.radius);
      first[e] = std::min(first[e], pose);
    }
  }
  return first;
}

std::vector<Clearance> brute_force_clearances(std::span<const Vec3> environment,
                                              const Query& query) {
  std::vector<Clearance> least(environment.size());
  for (std::uint32_t i = 0; i < query.poses.size(); ++i) {
    for (const Vec3& model_point : query.model) {
      const Vec3 m = transform(query.poses[i], model_point);
      for (std::size_t e = 0; e < environment.size(); ++e) {
        const double squared = squared_distance(environment[e], m);
        if (squared < least[e].squared) least[e] = {squared, i};
      }
    }
  }
  return least;
}

}  // namespace clearway
