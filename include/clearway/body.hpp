#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "clearway/model.hpp"
#include "clearway/pose.hpp"

namespace clearway {

/// One of several rigid parts of a vehicle. It moves in its own way while the vehicle follows its
/// path, which is given by the query's poses.
struct Body {
  std::string name;  ///< a single line of text, not empty and unique among the bodies of a vehicle
  Model model;       ///< the body's model, in the body's own frame
  std::vector<Pose> poses;  ///< the poses that the body has, in the order of the path
  /// For each entry of `poses`, the index of the path's pose; ascending
  std::vector<std::uint32_t> path_pose;
  /// Metres in the body's frame: takes the place of the query's floor for this body.
  std::optional<double> floor = {};
};

/// Limits of a vehicle: more bodies, or longer names, are refused.
inline constexpr std::size_t kMostBodies = 256, kMostNameBytes = 100;

}  // namespace clearway
