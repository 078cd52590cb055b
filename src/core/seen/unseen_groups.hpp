#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/seen/cubes.hpp"

namespace clearway {

/// Numbers the groups of cubes that touch each other by a face, an edge or a corner: from 1 on,
/// ordered by the least first pose of a group and then by its least cube. cubes: ascending,
/// distinct. first_poses: one for each cube. Returns the number of each cube's group.
std::vector<std::uint32_t> group_cubes(std::span<const Cube> cubes,
                                       std::span<const std::uint32_t> first_poses);

}  // namespace clearway
