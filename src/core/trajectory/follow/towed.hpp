#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clearway/follow.hpp"
#include "core/trajectory/follow/follow_path.hpp"

namespace clearway {

/// Farthest that a hitch or an axle may be from the origin of its body, metres.
inline constexpr double kFarthestHitch = 1e6;

/// Which body tows which, of a list of bodies.
struct Towing {
  /// What is wrong about the tower that a body names.
  struct Fault {
    std::size_t body;
    std::string what;
  };

  /// For each body the index of its tower; none where no other body tows it
  std::vector<std::optional<std::size_t>> tower;
  std::vector<std::size_t> order;  ///< the towed bodies, each after its tower
  std::optional<Fault> fault;      ///< where there is one, `order` is empty
};

/// Finds the towers by their names. names, mounts: one for each body.
Towing towing_of(std::span<const std::string> names, std::span<const BodyMount> mounts);

/// A body to be moved along a path, or behind another body.
struct MountedBody {
  BodyMount mount;
  /// The path that the body follows, if it is not towed by another body: the vehicle's, or for a
  /// body with a motion of its own, its own poses.
  const PathStations* path = nullptr;
  /// For each pose of `path` the index of the vehicle's pose; empty where they are the same
  std::span<const std::uint32_t> path_pose = {};
};

/// The poses of the towed bodies, each at its own index; the other entries stay empty. They are
/// found by driving along the paths in steps of at most 0.02 m (docs/design/bodies.md). A body that
/// is pushed backwards has `pushed_from`, and neither it nor the bodies behind it go on from there.
/// towing: without a fault. metres: length of the poses' unit in metres. Throws InputError for
/// paths that mirror the model, and for paths longer than 1000 km.
std::vector<FollowedPath> follow_towed(std::span<const MountedBody> bodies, const Towing& towing,
                                       double metres, int threads);

/// Why a towed body is refused that has `pushed_from`, and what is expected instead. path: the one
/// that the vehicle follows.
std::string pushed_text(const FollowedPath& followed, const PathStations& path);

}  // namespace clearway
