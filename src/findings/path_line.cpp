#include "findings/path_line.hpp"

#include <cmath>
#include <cstddef>

namespace clearway {

std::vector<double> chainage_of(const std::vector<Pose>& poses) {
  std::vector<double> out(poses.size());
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double* a = poses[i - 1].translation;
    const double* b = poses[i].translation;
    const double x = b[0] - a[0], y = b[1] - a[1], z = b[2] - a[2];
    out[i] = out[i - 1] + std::sqrt(x * x + y * y + z * z);
  }
  return out;
}

PathStretches::PathStretches(const std::vector<double>& chainage, double split) {
  if (split == 0) return;
  number_.resize(chainage.size());
  for (std::size_t i = 1; i < chainage.size(); ++i) {
    const bool cut = std::floor(chainage[i] / split) != std::floor(chainage[i - 1] / split);
    number_[i] = number_[i - 1] + (cut ? 1 : 0);
  }
}

}  // namespace clearway
