#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "clearway/query.hpp"
#include "clearway/vec3.hpp"
#include "core/query/clearance_set.hpp"

namespace clearway {

/// For every environment point its first pose (clearway/query.hpp), or HitSet::kNever. The
/// oracle of all tests: every pair is put to the predicate, and nothing but the predicate is shared
/// with the engines. O(|E| |M| |T|), on all cores. A surface has no motion between poses.
std::vector<std::uint32_t> brute_force_first_poses(std::span<const Vec3> environment,
                                                   const Query& query);

/// For every environment point the least d2 over every pair, however large, and the lowest pose
/// that has it; not found where no d2 is finite. Inside solids v of docs/design/solids.md, which is
/// below 0. Likewise an oracle.
std::vector<Clearance> brute_force_clearances(std::span<const Vec3> environment,
                                              const Query& query);

/// The nearest point of a pose, and the index in the environment as its source.
struct NearestPoint {
  /// The least d2, infinity where none is below the square of the profile's D; inside solids the
  /// least v, below 0.
  double squared;
  std::uint64_t source;
};

/// Of every pose over all points: the least d2, and the smallest source that has it. Likewise an
/// oracle.
std::vector<NearestPoint> brute_force_profile(std::span<const Vec3> environment,
                                              const Query& query);

}  // namespace clearway
