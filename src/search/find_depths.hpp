#pragma once

#include <cstdint>

#include "clearway/query.hpp"
#include "core/util/progress.hpp"
#include "io/store/store_reader.hpp"
#include "stream/answer_rows.hpp"

namespace clearway {

/// Finds for each colliding point of `rows` the nearest free point of the store, and the distance
/// to it (docs/design/pipeline.md), and adds them to `rows`, cell by cell, except where these are
/// known. query: says which points are ignored. threads: at least 1; fewer are used where
/// memory_bytes are short. The depths depend neither on threads nor on memory. Throws ResourceError
/// whose amount is the memory that would do, InputError for a damaged cell, Interrupted. Returns
/// the bytes that it took beyond depth_search_bytes() for free points.
std::uint64_t find_depths(const StoreReader& store, const Query& query, AnswerRows& rows,
                          int threads, std::uint64_t memory_bytes, Progress& progress);

/// Bytes that find_depths() takes with one thread, besides 9 for each block of the cells in which
/// points collide or are ignored.
std::uint64_t depth_search_bytes(const PackedCloud& cloud, const Query& query);

/// Throws UsageError where the store does not hold the whole scans, whose free points would be
/// missing.
void check_depth(const StoreReader& store, const QueryParameters& query);

}  // namespace clearway
