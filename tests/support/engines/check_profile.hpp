#pragma once

#include <vector>

#include "clearway/query.hpp"
#include "support/memory_cloud.hpp"

namespace clearway {

/// The profile that the query asks for, of every engine that has profiles, against brute force.
/// positions: of the cloud's points, by source. Returns how many poses have a point.
std::uint64_t check_profile(const MemoryCloud& cloud, const std::vector<Vec3>& positions,
                            const Query& query);

/// D of a profile, from far below the radius to far above it, beside other modes.
Query with_profile(Query query, std::size_t variant);

}  // namespace clearway
