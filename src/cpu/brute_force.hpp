#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/question.hpp"
#include "core/vec3.hpp"

namespace clearway {

/// For every environment point the smallest pose index that touches it, or HitSet::kNever. The
/// oracle of all tests: every pair is put to the predicate, and nothing but the predicate is shared
/// with the engines. O(|E| |M| |T|), on all cores.
std::vector<std::uint32_t> brute_force_first_poses(std::span<const Vec3> environment,
                                                   const Question& question);

}  // namespace clearway
