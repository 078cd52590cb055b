#include "cpu/brute_force.hpp"

#include <limits>

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

/// The same on the way from a pose to the next, both included.
bool touched_on_way(const Vec3& e, const std::vector<Vec3>& from, const std::vector<Vec3>& to,
                    double radius) {
  for (std::size_t m = 0; m < to.size(); ++m) {
    if (collides(e, from[m], radius) || collides_inside(e, from[m], to[m], radius) ||
        collides(e, to[m], radius)) {
      return true;
    }
  }
  return false;
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
      if (first[e] != HitSet::kNever) continue;
      if (moves_on ? touched_on_way(environment[e], from, to, query.radius)
                   : touched(environment[e], from, query.radius)) {
        first[e] = i;
      }
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

std::vector<NearestPoint> brute_force_profile(std::span<const Vec3> environment,
                                              const Query& query) {
  const double limit = rounded_product(query.profile, query.profile);
  std::vector<NearestPoint> profile(query.poses.size());
#pragma omp parallel for schedule(dynamic, 1)
  for (std::size_t i = 0; i < query.poses.size(); ++i) {
    NearestPoint best{std::numeric_limits<double>::infinity(), ~std::uint64_t{0}};
    const std::vector<Vec3> moved = moved_model(query, i);
    for (std::size_t e = 0; e < environment.size(); ++e) {
      for (const Vec3& m : moved) {
        const double squared = squared_distance(environment[e], m);
        if (squared < limit && squared < best.squared) best = {squared, e};
      }
    }
    profile[i] = best;
  }
  return profile;
}

}  // namespace clearway
