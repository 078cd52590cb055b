#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace clearway {

/// Consecutive finite points of the environment in the store's integers.
struct QuantaBatch {
  std::size_t file = 0;            ///< number of the input, which all points are of
  std::uint64_t first_source = 0;  ///< source index of the batch's first input point
  std::vector<std::array<std::int32_t, 3>> quanta;
  std::vector<std::uint32_t> offsets;  ///< source - first_source, empty where it is the position

  std::uint64_t source(std::size_t i) const {
    return first_source + (offsets.empty() ? i : offsets[i]);
  }
};

}  // namespace clearway
