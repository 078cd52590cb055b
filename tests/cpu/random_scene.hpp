#pragma once

#include <vector>

#include "support/engines/scene_checks.hpp"
#include "support/scenes.hpp"

namespace clearway::test {

inline const Quantisation kTenthMillimetre{{1e-4, 1e-4, 1e-4}, {0, 0, 0}};
inline const Box kRoom{{-4, -3, -1}, {5, 4, 2}};
inline const Box kPart{{-0.6, -0.4, -0.3}, {0.7, 0.5, 0.2}};

/// A random cloud in kRoom, a random model and a random path through the room.
struct Scene : SceneChecks<Scene> {
  Random random{7};
  Quantisation quantisation = kTenthMillimetre;
  std::vector<Quantum> points = quantise(random_points(random, kRoom, 3000), quantisation);
  std::vector<Vec3> model = random_points(random, kPart, 60);
  std::vector<Pose> poses = smooth_path(random, kRoom, 40);
  double radius = 0.3;

  Query query() const { return {model, poses, {radius}}; }
};

}  // namespace clearway::test
