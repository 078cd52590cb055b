#include "findings/path_stretches.hpp"

#include <cmath>
#include <cstddef>

namespace clearway {

PathStretches::PathStretches(const std::vector<double>& chainage, double split) {
  if (split == 0) return;
  number_.resize(chainage.size());
  for (std::size_t i = 1; i < chainage.size(); ++i) {
    const bool cut = std::floor(chainage[i] / split) != std::floor(chainage[i - 1] / split);
    number_[i] = number_[i - 1] + (cut ? 1 : 0);
  }
}

}  // namespace clearway
