#pragma once

#include <cstdint>

#include "support/engines/engines.hpp"

namespace clearway::test {

/// Compares a scene that has `points`, `quantisation`, `poses` and `query()` with brute force. Each
/// check returns how many were found.
template <typename Scene>
struct SceneChecks {
  std::uint64_t check() const {
    return check_engines(scene().points, scene().quantisation, scene().query());
  }

  std::uint64_t check_clearance(double clearance) const {
    std::uint64_t found = 0;
    for (const bool first_pose : {false, true}) {
      Query asked = scene().query();
      asked.clearance = clearance;
      asked.first_pose = first_pose;
      found = check_clearances(scene().points, scene().quantisation, asked);
    }
    return found;
  }

  std::uint64_t check_profile(double distance) const {
    Query asked = scene().query();
    asked.profile = distance;
    return clearway::check_profile(scene().points, scene().quantisation, asked);
  }

  void move_far_away(const Vec3& offset) {
    auto& here = static_cast<Scene&>(*this);
    for (int k = 0; k < 3; ++k) here.quantisation.offset[k] += offset[k];
    for (Pose& pose : here.poses) {
      for (int k = 0; k < 3; ++k) pose.translation[k] += offset[k];
    }
  }

 private:
  const Scene& scene() const { return static_cast<const Scene&>(*this); }
};

}  // namespace clearway::test
