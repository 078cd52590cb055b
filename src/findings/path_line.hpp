#pragma once

#include <cstdint>
#include <vector>

#include "clearway/pose.hpp"

namespace clearway {

/// How far along the positions of the poses each one lies: the sum of the distances of consecutive
/// positions, from 0.
std::vector<double> chainage_of(const std::vector<Pose>& poses);

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
