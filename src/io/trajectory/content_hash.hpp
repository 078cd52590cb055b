#pragma once

#include <cstdint>
#include <span>

#include "clearway/body.hpp"
#include "clearway/pose.hpp"

namespace clearway {

/// xxh64, seed 0, over the coordinates x, y, z of every vertex, each as 8 little-endian bytes; then
/// the indices of each triangle, as 4 little-endian bytes each; then the number of each triangle's
/// solid, where there are any, as 4 more. So it is equal for equal models whatever file they came
/// from.
std::uint64_t hash_of_model(const Model& model);

/// The same over the 12 numbers of every pose: the rotation row by row, then the translation.
std::uint64_t hash_of_trajectory(std::span<const Pose> poses);

/// Of each body: the length of its name and the name, hash_of_model, the number of its poses, of
/// each the index of the path's pose (uint32), and hash_of_trajectory. Lengths, numbers and hashes
/// as 8 little-endian bytes.
std::uint64_t hash_of_bodies(std::span<const Body> bodies);

}  // namespace clearway
