#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "bench/measure/record.hpp"

/// A scene whose points lie at the decision boundary: a model of one point at the origin, a pose
/// that leaves it there, and points on the x axis whose distance is exactly `radius` plus or minus
/// some ulps.
namespace clearway::bench {

/// The number of ulps of the radius by which each point lies beyond it: 0, and random numbers of
/// every octave from 1 to 2^31, of both signs.
std::vector<std::int32_t> steps_beside_boundary();

/// Writes the scene; existing files are replaced. radius: such that radius + k ulps is a double for
/// every k of steps_beside_boundary().
void write_boundary_scene(const std::filesystem::path& las, const std::filesystem::path& model,
                          const std::filesystem::path& trajectory, double radius);

/// How a result for the boundary scene decides: false hits and misses and, as element i of "points"
/// and "wrong", how many points lie 2^i to 2^(i+1) - 1 ulps off the boundary (0 counts among the
/// first), and how many of them are decided wrongly.
Json decided_at_boundary(const std::filesystem::path& result);

}  // namespace clearway::bench
