#pragma once

#include <cstdint>
#include <vector>

#include "clearway/query.hpp"
#include "core/cloud/packed_cloud.hpp"
#include "search/query_trees.hpp"

namespace clearway {

/// An estimate, for each cell, of the work that a search has with it, in an arbitrary unit; 0 where
/// the model comes nowhere near. It follows from the store's index and the query alone, by
/// operations that give the same numbers on every machine. Reads no points. threads: at least 1.
std::vector<std::uint64_t> cell_work(const PackedCloud& cloud, const Query& query,
                                     const QueryTrees& trees, int threads);

/// Bytes of memory that cell_work() takes beside the trees.
std::uint64_t cell_work_bytes(const PackedCloud& cloud, const Query& query);

}  // namespace clearway
