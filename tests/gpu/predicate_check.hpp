#pragma once

#include <vector>

#include "clearway/pose.hpp"
#include "core/geometry/predicate.hpp"

namespace clearway {

/// One pair for the predicate, which the kernel and its host twin decide by the same body.
struct PredicateCase {
  Vec3 environment;
  Vec3 model;
  Pose pose;
  Pose next;  ///< the pose to which the model point moves from `pose`
  double radius;
};

struct PredicateAnswer {
  double squared_distance;
  bool hit;
  bool inside;  ///< whether the inside of the segment to the next pose hits
};

CLEARWAY_HD inline PredicateAnswer decide(const PredicateCase& c) {
  const Vec3 moved = transform(c.pose, c.model);
  return {squared_distance(c.environment, moved), collides(c.environment, moved, c.radius),
          collides_inside(c.environment, moved, transform(c.next, c.model), c.radius)};
}

/// Computes the predicate's answers on the current CUDA device. They are the host's bit for bit, or
/// else the device must not be used. Throws ResourceError with CUDA's own words.
std::vector<PredicateAnswer> decide_on_device(const std::vector<PredicateCase>& cases);

}  // namespace clearway
