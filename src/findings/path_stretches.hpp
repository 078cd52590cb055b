#pragma once

#include <cstdint>
#include <vector>

namespace clearway {

/// The path cut into stretches at multiples of a length.
class PathStretches {
 public:
  /// split: the length, above 0, or 0 for one single stretch.
  PathStretches(const std::vector<double>& chainage, double split);

  /// The number of the stretch that a pose is in. Stretches that have a pose are numbered
  /// consecutively from 0.
  std::uint32_t operator[](std::uint32_t pose) const { return number_.empty() ? 0 : number_[pose]; }

 private:
  /// The stretch of each pose; empty where there is only one.
  std::vector<std::uint32_t> number_;
};

}  // namespace clearway
