#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "clearway/model.hpp"
#include "clearway/pose.hpp"

namespace clearway {

/// One of several rigid parts of a vehicle, which moves in its own way while the vehicle follows
/// its path: the query's poses.
struct Body {
  std::string name;                      ///< not empty, in one line, no other body's
  Model model;                           ///< in the body's own frame
  std::vector<Pose> poses;               ///< those that it has, in the order of the path
  std::vector<std::uint32_t> path_pose;  ///< of each, the index of the path's pose; ascending
};

/// More bodies than this are refused, and longer names.
inline constexpr std::size_t kMostBodies = 256, kMostNameBytes = 100;

}  // namespace clearway
