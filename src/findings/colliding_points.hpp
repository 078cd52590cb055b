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
      sizeof(QuantumPoint) + sizeof(std::uint64_t) + sizeof(std::uint32_t);

  std::vector<QuantumPoint> quanta;
  std::vector<std::uint64_t> source;  ///< ascending
  std::vector<std::uint32_t> first_pose;
};

/// Throws InputError as ResultRowStream does, and for coordinates that are not those of stored
/// integers.
CollidingPoints read_colliding_points(const ResultReader& result, Progress& progress);

}  // namespace clearway
