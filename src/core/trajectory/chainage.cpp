#include "core/trajectory/chainage.hpp"

#include <cmath>

#include "core/geometry/predicate.hpp"

namespace clearway {
namespace {

double step_length(const Pose& from, const Pose& to) {
  return std::sqrt(squared_distance(to.position(), from.position()));
}

}  // namespace

std::vector<double> chainage_of(std::span<const Pose> poses) {
  std::vector<double> chainage(poses.size());
  for (std::size_t i = 1; i < poses.size(); ++i) {
    chainage[i] = chainage[i - 1] + step_length(poses[i - 1], poses[i]);
  }
  return chainage;
}

double path_length(std::span<const Pose> poses) {
  double length = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) length += step_length(poses[i - 1], poses[i]);
  return length;
}

}  // namespace clearway
