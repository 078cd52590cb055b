#include "cpu/brute_force.hpp"

#include "core/hit_set.hpp"
#include "core/predicate.hpp"

namespace clearway {
namespace {

constexpr std::size_t kPairsWorthThreads = 1'000'000;

}  // namespace

std::vector<std::uint32_t> brute_force_first_poses(std::span<const Vec3> environment,
                                                   const Question& question) {
  std::vector<std::uint32_t> first(environment.size(), HitSet::kNever);
  for (std::uint32_t i = 0; i < question.poses.size(); ++i) {
    std::vector<Vec3> moved;
    moved.reserve(question.model.size());
    for (const Vec3& m : question.model) moved.push_back(transform(question.poses[i], m));
    const bool worth_threads = environment.size() * moved.size() > kPairsWorthThreads;
#pragma omp parallel for schedule(static) if (worth_threads)
    for (std::size_t e = 0; e < environment.size(); ++e) {
      if (first[e] != HitSet::kNever) continue;
      for (const Vec3& m : moved) {
        if (collides(environment[e], m, question.radius)) {
          first[e] = i;
          break;
        }
      }
    }
  }
  return first;
}

std::vector<Clearance> brute_force_clearances(std::span<const Vec3> environment,
                                              const Question& question) {
  std::vector<Clearance> least(environment.size());
  for (std::uint32_t i = 0; i < question.poses.size(); ++i) {
    for (const Vec3& model_point : question.model) {
      const Vec3 m = transform(question.poses[i], model_point);
      for (std::size_t e = 0; e < environment.size(); ++e) {
        const double squared = squared_distance(environment[e], m);
        if (squared < least[e].squared) least[e] = {squared, i};
      }
    }
  }
  return least;
}

}  // namespace clearway
