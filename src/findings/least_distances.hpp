#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "clearway/vec3.hpp"
#include "core/util/progress.hpp"
#include "io/result/result.hpp"

namespace clearway {

/// The nearest point of a conflict.
struct ConflictDistance {
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  double distance = 0;           ///< metres, below 0 inside solids
  std::uint64_t source = kNone;  ///< of equally near ones the smallest
  std::uint32_t pose = 0;
  std::optional<Vec3> xyz;                 ///< none in files before version 3
  std::optional<std::uint32_t> body = {};  ///< of a vehicle
  std::uint64_t inside = 0;                ///< points with a distance below 0
};

/// Joins the clearances with the colliding points, of which both are ascending by source. For each
/// conflict number up to `conflicts`, at its number. conflict_of: by row; 0: none.
std::vector<ConflictDistance> least_distances(const ResultReader& result,
                                              std::span<const std::uint64_t> source,
                                              std::span<const std::uint32_t> conflict_of,
                                              std::size_t conflicts, Progress& progress);

}  // namespace clearway
