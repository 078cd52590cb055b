#pragma once

#include <cstdint>
#include <vector>

#include "core/util/progress.hpp"
#include "findings/group/cell_grid.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// The rows of a result, of which conflicts are made.
struct CollidingPoints {
  static constexpr std::uint64_t kBytesOfPoint =
      sizeof(QuantumPoint) + sizeof(std::uint64_t) + 2 * sizeof(std::uint32_t) + 1;

  std::vector<QuantumPoint> quanta;
  std::vector<std::uint64_t> source;  ///< ascending
  std::vector<std::uint32_t> first_pose;
  std::vector<std::uint32_t> last_pose;  ///< the first one where the result has none
  std::vector<std::uint8_t> body;        ///< of the first pose; empty without bodies
};

/// Throws InputError as ResultRowStream does, and for coordinates that are not those of stored
/// integers.
CollidingPoints read_colliding_points(const ResultReader& result, Progress& progress);

}  // namespace clearway
