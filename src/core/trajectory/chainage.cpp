#include "core/trajectory/chainage.hpp"

#include <cmath>

#include "core/geometry/predicate.hpp"

namespace clearway {

std::vector<double> chainage_of(std::span<const Pose> poses) {
  std::vector<double> chainage(poses.size());
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double* from = poses[i - 1].translation;
    const double* to = poses[i].translation;
    const double square = squared_length(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
    chainage[i] = chainage[i - 1] + std::sqrt(square);
  }
  return chainage;
}

}  // namespace clearway
