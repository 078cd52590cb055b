#pragma once

#include <variant>
#include <vector>

#include "clearway/body.hpp"
#include "clearway/pose.hpp"
#include "clearway/progress.hpp"

namespace clearway {

/// A body that has the path's own pose so many metres ahead of each pose; negative: behind.
struct BodyStation {
  double at = 0;
};

/// A body that lies on the path with two places, so many metres ahead of each pose. Its x axis
/// points from the rear one to the front one; its origin divides the chord as 0 divides the two.
struct BodyPivots {
  double front = 0, rear = 0;  ///< not equal
};

using BodyMount = std::variant<BodyStation, BodyPivots>;

/// The body, of which name and model count, with the poses that it has while it follows the path
/// (docs/design/bodies.md). Where a station is off the path it has none. warnings: where given, of
/// what is missing or odd are appended. Throws UsageError for pivots that are equal, InputError for
/// paths that mirror, and where the body has a pose nowhere.
Body follow(Body body, const std::vector<Pose>& path, const BodyMount& mount,
            std::vector<Message>* warnings = nullptr);

}  // namespace clearway
