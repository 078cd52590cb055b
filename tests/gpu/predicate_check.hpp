#pragma once

#include <vector>

#include "clearway/pose.hpp"
#include "core/geometry/predicate.hpp"

namespace clearway {

/// One pair put to the predicate, by the body that the kernel and its host twin share.
struct PredicateCase {
  Vec3 environment;
  Vec3 model;
  Pose pose;
  Pose next;  ///< the model point moves to it from pose
  double radius;
};

struct PredicateAnswer {
  double squared_distance;
  bool hit;
  bool inside;  ///< hit by the inside of the segment to the next pose
};

CLEARWAY_HD inline PredicateAnswer decide(const PredicateCase& c) {
  const Vec3 moved = transform(c.pose, c.model);
  return {squared_distance(c.environment, moved), collides(c.environment, moved, c.radius),
          collides_inside(c.environment, moved, transform(c.next, c.model), c.radius)};
}

/// The predicate's answers computed on the current CUDA device: bit for bit the host's, or the
/// device must not be used. Throws ResourceError with CUDA's own words.
std::vector<PredicateAnswer> decide_on_device(const std::vector<PredicateCase>& cases);

}  // namespace clearway
