#pragma once

#include <string>
#include <variant>
#include <vector>

#include "clearway/body.hpp"
#include "clearway/pose.hpp"
#include "clearway/progress.hpp"

namespace clearway {

/// How a body with one place on the path follows it: at each pose it has the path's own pose `at`
/// metres ahead; negative means behind.
struct BodyStation {
  double at = 0;
};

/// How a body with two pivots follows the path. The pivots lie `front` and `rear` metres ahead of
/// each pose. The body's x axis points from the rear pivot to the front one; its origin divides the
/// chord as 0 divides the interval from rear to front.
struct BodyPivots {
  double front = 0, rear = 0;  ///< must differ
};

/// How a towed body, such as a trailer, moves: it is coupled to its tower at a hitch, and its axle
/// rolls behind without slipping sideways. docs/design/bodies.md has the rules.
struct BodyTowed {
  std::string by;  ///< name of the body that tows it; empty: the path's pose tows it
  double at = 0;   ///< x of the hitch in the tower's own frame, metres
  /// x of the hitch and of the axle in the body's own frame, metres; hitch > axle
  double hitch = 0, axle = 0;
};

/// How a body with a motion of its own moves: it keeps the poses that it has.
struct BodyOwnPoses {};

using BodyMount = std::variant<BodyStation, BodyPivots, BodyTowed, BodyOwnPoses>;

/// Returns `body`, of which only name and model count, with the poses that it has while it follows
/// the path (docs/design/bodies.md). Where a station is off the path it has no pose. warnings:
/// where given, what is missing or odd is appended. Throws UsageError for pivots that are equal or
/// in the wrong order, and for a body that is towed by another one; InputError for paths that
/// mirror, for a towed body that is pushed backwards, and if the body has no pose anywhere.
Body follow(Body body, const std::vector<Pose>& path, const BodyMount& mount,
            std::vector<Message>* warnings = nullptr);

/// Returns all bodies of a vehicle with their poses, as the call for one body does. Only here may a
/// body be towed by another one, in any order of the bodies. mounts: one for each body. Throws what
/// that call throws, and UsageError for names that no body or two bodies have and for bodies that
/// tow each other in a ring.
std::vector<Body> follow(std::vector<Body> bodies, const std::vector<Pose>& path,
                         const std::vector<BodyMount>& mounts,
                         std::vector<Message>* warnings = nullptr);

}  // namespace clearway
