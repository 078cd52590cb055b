#pragma once

#include <cstdint>

#include "clearway/query.hpp"
#include "core/query/search_result.hpp"
#include "core/util/progress.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {

/// What find_depths() reads besides the store. All of it outlives the call.
struct DepthSearch {
  const Query& query;         ///< says which points are ignored
  const SearchResult& found;  ///< the colliding points
  const HitSet* below;        ///< the points that collide without floors; null where there are none
  int threads;                ///< at least 1; fewer are used where memory is short
  std::uint64_t memory_bytes;  ///< what the search may take besides the mapped store
};

/// Finds for each colliding point the nearest free point of the store, and the distance to it
/// (docs/design/depth.md). The depths depend neither on threads nor on memory. Throws ResourceError
/// whose amount is the memory that would do, InputError for a damaged cell, Interrupted.
DepthSet find_depths(const StoreReader& store, const DepthSearch& search, Progress& progress);

/// Bytes that find_depths() takes with one thread, besides 16 for each colliding point.
std::uint64_t depth_search_bytes(const PackedCloud& cloud);

/// Throws UsageError where the store does not hold the whole scans, whose free points would be
/// missing.
void check_depth(const StoreReader& store, const QueryParameters& query);

}  // namespace clearway
