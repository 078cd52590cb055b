#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "clearway/query.hpp"
#include "clearway/vec3.hpp"
#include "core/query/search_result.hpp"

namespace clearway {

/// The first pose of every environment point (clearway/query.hpp), or kNoPose. The oracle of
/// all tests: it evaluates the predicate for every pair, and shares nothing but the predicate with
/// the engines. O(|E| |M| |T|), on all cores. Supports motion between poses for models of points
/// only.
std::vector<std::uint32_t> brute_force_first_poses(std::span<const Vec3> environment,
                                                   const Query& query);

/// An oracle for clearances: for every environment point the least d2 over every pair, however
/// large, and the lowest pose that has it; not found if no d2 is finite. Inside solids it is v of
/// docs/design/model.md, which is below 0.
std::vector<Clearance> brute_force_clearances(std::span<const Vec3> environment,
                                              const Query& query);

/// The environment point nearest to the model at a pose; its source is the index in the
/// environment.
struct NearestPoint {
  /// The least d2, infinity if none is below the square of the profile's distance D; inside solids
  /// the least v, below 0.
  double squared;
  std::uint64_t source;
};

/// An oracle for profiles: for every pose the least d2 over all points, and the smallest source
/// index that has it.
std::vector<NearestPoint> brute_force_profile(std::span<const Vec3> environment,
                                              const Query& query);

}  // namespace clearway
