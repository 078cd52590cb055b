#pragma once

#include <cstdint>
#include <vector>

#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "search/query_trees.hpp"

namespace clearway {

/// Of every cell an estimate of the work that a search has with it, in no unit; 0 where the model
/// comes nowhere near. Follows from the store's index and the query alone: additions, products and
/// roots, which are the same on every machine. Reads no points.
std::vector<std::uint64_t> cell_work(const PackedCloud& cloud, const Query& query,
                                     const QueryTrees& trees);

}  // namespace clearway
