#pragma once

#include <cstdint>
#include <span>

#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// xxh64, seed 0, over the coordinates x, y, z of every point, each as 8 little-endian bytes: equal
/// for equal points whatever file they came from.
std::uint64_t hash_of_model(std::span<const Vec3> points);

/// The same over the 12 numbers of every pose: the rotation row by row, then the translation.
std::uint64_t hash_of_trajectory(std::span<const Pose> poses);

}  // namespace clearway
