#pragma once

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

using BodyMount = std::variant<BodyStation, BodyPivots>;

/// Returns `body`, of which only name and model count, with the poses that it has while it follows
/// the path (docs/design/bodies.md). Where a station is off the path it has no pose. warnings:
/// where given, what is missing or odd is appended. Throws UsageError for pivots that are equal;
/// InputError for paths that mirror, and if the body has no pose anywhere.
Body follow(Body body, const std::vector<Pose>& path, const BodyMount& mount,
            std::vector<Message>* warnings = nullptr);

}  // namespace clearway
