#pragma once

#include <cstdint>
#include <span>

#include "clearway/query.hpp"
#include "support/memory_cloud.hpp"

namespace clearway {

struct ToleratedResults {
  std::uint64_t colliding = 0;  ///< number of points that collide in truth
  std::uint64_t differing = 0;  ///< number of answers, of all engines, that differ from the truth
};

/// Runs every engine that can search within a tolerance on the points, packed in several ways.
/// Checks that an answer is wrong only where the least distance, by brute force, is within the
/// tolerance of the radius, and that an engine answers alike however the points are packed.
ToleratedResults check_tolerance(std::span<const Quantum> points, const Quantisation& quantisation,
                                 const Query& query, double tolerance);

}  // namespace clearway
