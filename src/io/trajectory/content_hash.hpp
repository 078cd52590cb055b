#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "clearway/body.hpp"
#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// xxh64, seed 0, over the coordinates x, y, z of every point, each as 8 little-endian bytes: equal
/// for equal points whatever file they came from.
std::uint64_t hash_of_model(std::span<const Vec3> points);

/// Of a surface: the same over the corners, then the indices of each triangle as 4 little-endian
/// bytes each, then of each triangle the number of its solid, where there are any, as 4 more.
/// Without triangles that of the points.
std::uint64_t hash_of_model(std::span<const Vec3> points,
                            std::span<const std::array<std::uint32_t, 3>> triangles,
                            std::span<const std::uint32_t> solid_of = {});

/// The same over the 12 numbers of every pose: the rotation row by row, then the translation.
std::uint64_t hash_of_trajectory(std::span<const Pose> poses);

/// Of each body: the length of its name and the name, hash_of_model, the number of its poses, of
/// each the index of the path's pose (uint32), and hash_of_trajectory. Lengths, numbers and hashes
/// as 8 little-endian bytes.
std::uint64_t hash_of_bodies(std::span<const Body> bodies);

}  // namespace clearway
