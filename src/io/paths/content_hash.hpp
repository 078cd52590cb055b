#pragma once

#include <cstdint>
#include <span>

#include "clearway/body.hpp"
#include "clearway/pose.hpp"

namespace clearway {

/// Hash of a model: xxh64, seed 0, over the coordinates x, y, z of every vertex, each as 8
/// little-endian bytes; then the indices of each triangle, as 4 little-endian bytes each; then,
/// where there are solids, the number of each triangle's solid, as 4 bytes. It is equal for equal
/// models, whatever file they came from.
std::uint64_t hash_of_model(const Model& model);

/// Hash of a trajectory: xxh64, seed 0, over the 12 numbers of every pose, each as 8 little-endian
/// bytes: the rotation row by row, then the translation.
std::uint64_t hash_of_trajectory(std::span<const Pose> poses);

/// Hash of bodies: xxh64, seed 0, over the following for each body: the length of its name and the
/// name, hash_of_model(), the number of its poses, for each of them the index of the path's pose
/// (uint32), and hash_of_trajectory(). Lengths, numbers and hashes are 8 little-endian bytes.
std::uint64_t hash_of_bodies(std::span<const Body> bodies);
/// Hash of bodies as above. models: hash_of_model() of each body's model, in their order.
std::uint64_t hash_of_bodies(std::span<const Body> bodies, std::span<const std::uint64_t> models);

}  // namespace clearway
