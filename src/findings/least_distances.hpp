#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "clearway/vec3.hpp"
#include "core/util/progress.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// The point of a conflict that is nearest to the model.
struct ConflictDistance {
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  double distance = 0;  ///< metres, below 0 inside solids
  /// Source index; of equally near points the smallest.
  std::uint64_t source = kNone;
  std::uint32_t pose = 0;
  std::optional<Vec3> xyz;  ///< missing in files before version 3
  /// The body that is so near, for a vehicle.
  std::optional<std::uint32_t> body = {};
  std::uint64_t inside = 0;  ///< number of points with a distance below 0
};

/// Joins the clearances with the colliding points; both are in ascending order of their source.
/// Returns the nearest point of each conflict at the conflict's number, from 1 to `conflicts`.
/// conflict_of: the conflict of each row, 0 for none.
std::vector<ConflictDistance> least_distances(const ResultReader& result,
                                              std::span<const std::uint64_t> source,
                                              std::span<const std::uint32_t> conflict_of,
                                              std::size_t conflicts, Progress& progress);

}  // namespace clearway
