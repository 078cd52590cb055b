#pragma once

#include <vector>

#include "clearway/query.hpp"
#include "support/engines/brute_force.hpp"
#include "support/memory_cloud.hpp"

namespace clearway {

/// The nearest point of every pose by brute force, however far it is.
std::vector<NearestPoint> nearest_points(const std::vector<Vec3>& positions, Query query);

/// Checks the profile that the query asks for, of every engine that has profiles, against the
/// nearest points. Returns how many poses have a point.
std::uint64_t check_profile(const MemoryCloud& cloud, std::vector<NearestPoint> nearest,
                            const Query& query);

/// The query with a profile distance from far below the radius to far above it, and with other
/// modes, as `variant` chooses.
Query with_profile(Query query, std::size_t variant);

}  // namespace clearway
