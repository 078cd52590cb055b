#pragma once

#include <cstdint>
#include <span>

#include "clearway/query.hpp"
#include "support/memory_cloud.hpp"

namespace clearway {

struct ToleratedResults {
  std::uint64_t colliding = 0;  ///< points, exactly
  std::uint64_t differing = 0;  ///< answers of all engines that are not exact
};

/// Runs every engine that takes a tolerance on the points, packed in several ways, and checks that
/// an answer is wrong only where the least distance, by brute force, is within the tolerance of the
/// radius, and that an engine says the same however the points are packed.
ToleratedResults check_tolerance(std::span<const Quantum> points, const Quantisation& quantisation,
                                 const Query& query);

}  // namespace clearway
