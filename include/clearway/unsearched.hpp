#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "clearway/body.hpp"
#include "clearway/pose.hpp"

namespace clearway {

/// A stretch of the path on which bodies of a vehicle have no pose, for example because a pivot has
/// left the path. Nothing is known of these bodies there, so a result without collisions does not
/// say that they are clear.
struct UnsearchedStretch {
  /// The first and the last pose of the path there at which one of `bodies` has none
  std::uint32_t first_pose = 0, last_pose = 0;
  /// Metres along the positions of the path. The stretch reaches to the poses that all of `bodies`
  /// have again, because a body is searched only between two poses that it has.
  double chainage_from = 0, chainage_to = 0;
  std::vector<std::uint32_t> bodies;  ///< the bodies without a pose, ascending
  bool has_answer = false;            ///< whether other bodies were searched there
};

/// The stretches on which not all of `bodies` are searched, in the order of the path. A body is
/// searched from one path pose to the next if it has both poses. Empty if there are no bodies,
/// because a model has every pose of the path.
std::vector<UnsearchedStretch> unsearched_stretches(std::span<const Pose> path,
                                                    std::span<const Body> bodies);

/// How much of a path was searched, in metres along its positions.
struct SearchedLength {
  double path = 0;   ///< length of the whole path
  double whole = 0;  ///< length of the stretches on which all bodies are searched
  /// Length of the stretches on which some bodies are searched and others are not
  double part = 0;

  friend bool operator==(const SearchedLength&, const SearchedLength&) = default;
};

/// First and last pose of each run of path poses at which no body has a pose, ascending. Empty if
/// there are no bodies.
std::vector<std::array<std::uint32_t, 2>> poses_without_bodies(std::size_t path_poses,
                                                               std::span<const Body> bodies);

SearchedLength searched_length(std::span<const Pose> path, std::span<const Body> bodies);

}  // namespace clearway
