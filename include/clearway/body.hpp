#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// Of a triangle that belongs to no solid.
inline constexpr std::uint32_t kNoSolid = 0xffffffff;

/// How many solids a model has. solid_of: see Query::solid_of.
inline std::uint64_t solid_count(std::span<const std::uint32_t> solid_of) {
  std::uint64_t count = 0;
  for (const std::uint32_t solid : solid_of) {
    if (solid != kNoSolid && solid >= count) count = solid + std::uint64_t{1};
  }
  return count;
}

/// One of several rigid parts of a vehicle, which moves in its own way while the vehicle follows
/// its path: the query's poses.
struct Body {
  std::string name;                      ///< not empty, in one line, no other body's
  std::vector<Vec3> model;               ///< in the body's own frame, metres: see Query::model
  std::vector<Pose> poses;               ///< those that it has, in the order of the path
  std::vector<std::uint32_t> path_pose;  ///< of each, the index of the path's pose; ascending
  std::vector<std::array<std::uint32_t, 3>> triangles = {};  ///< as Query::triangles
  std::vector<std::uint32_t> solid_of = {};                  ///< as Query::solid_of
  double model_spacing = 0;                                  ///< as Query::model_spacing

  bool is_surface() const { return !triangles.empty(); }
  bool is_solid() const { return !solid_of.empty(); }
};

/// More bodies than this are refused, and longer names.
inline constexpr std::size_t kMostBodies = 256, kMostNameBytes = 100;

}  // namespace clearway
