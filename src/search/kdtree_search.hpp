#pragma once

#include "search/page_search.hpp"

namespace clearway {

/// The most bytes that a search with engine kdtree takes, beside the mapped store. options.threads
/// is not 0.
std::uint64_t kdtree_needed_bytes(const StoreReader& store, const Query& query,
                                  const SearchOptions& options);

/// Searches all cells, or those of `only`, with engine kdtree. options.threads is not 0. Throws
/// ResourceError where the memory is too little.
Found search_kdtree(const StoreReader& store, const Query& query, const ShardCells* only,
                    const SearchOptions& options, SearchJournal* journal, Progress& progress,
                    SearchReport& report);

}  // namespace clearway
