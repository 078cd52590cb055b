#pragma once

#include <cstdint>
#include <vector>

#include "core/util/progress.hpp"
#include "findings/group/cell_grid.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// The rows of a result that conflicts are made of.
struct CollidingPoints {
  static constexpr std::uint64_t kBytesOfPoint =
      sizeof(QuantumPoint) + sizeof(std::uint64_t) + 2 * sizeof(std::uint32_t) + 3;

  std::vector<QuantumPoint> quanta;
  std::vector<std::uint64_t> source;  ///< ascending
  std::vector<std::uint32_t> first_pose;
  /// The first pose where the result has no last poses.
  std::vector<std::uint32_t> last_pose;
  /// The body that collides at the first pose; empty for a result without bodies.
  std::vector<std::uint8_t> body;
  /// With an error budget, what it says of each point; otherwise empty.
  enum Kind : std::uint8_t { kNear, kColliding, kCertain };
  std::vector<std::uint8_t> kind;
  std::vector<std::uint8_t> point_class;  ///< empty unless the scans have classes
};

/// Reads all colliding points of a result, and with an error budget the near ones too. Throws
/// InputError as RowStream does, and for coordinates that are not those of stored integers.
CollidingPoints read_colliding_points(const ResultReader& result, Progress& progress);

}  // namespace clearway
