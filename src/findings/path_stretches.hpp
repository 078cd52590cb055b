#pragma once

#include <cstdint>
#include <vector>

namespace clearway {

/// The path cut at multiples of a length.
class PathStretches {
 public:
  /// split: above 0, or 0 for one stretch.
  PathStretches(const std::vector<double>& chainage, double split);

  /// Consecutive numbers of the stretches that have a pose, from 0.
  std::uint32_t operator[](std::uint32_t pose) const { return number_.empty() ? 0 : number_[pose]; }

 private:
  std::vector<std::uint32_t> number_;  ///< for each pose; empty: one stretch
};

}  // namespace clearway
