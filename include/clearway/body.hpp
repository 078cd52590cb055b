#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "clearway/pose.hpp"
#include "clearway/vec3.hpp"

namespace clearway {

/// One of several rigid parts of a vehicle, which moves in its own way while the vehicle follows
/// its path: the query's poses.
struct Body {
  std::string name;                      ///< not empty, in one line, no other body's
  std::vector<Vec3> model;               ///< in the body's own frame, metres: see Query::model
  std::vector<Pose> poses;               ///< those that it has, in the order of the path
  std::vector<std::uint32_t> path_pose;  ///< of each, the index of the path's pose; ascending
  std::vector<std::array<std::uint32_t, 3>> triangles = {};  ///< as Query::triangles

  bool is_surface() const { return !triangles.empty(); }
};

/// More bodies than this are refused, and longer names.
inline constexpr std::size_t kMostBodies = 256, kMostNameBytes = 100;

}  // namespace clearway
