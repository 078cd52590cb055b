#pragma once

#include "search/page_search.hpp"

namespace clearway {

/// Searches with engine kdtree; options.threads is not 0. Throws ResourceError where the memory is
/// too little.
Found search_kdtree(const StoreReader& store, const Query& query, const SearchOptions& options,
                    SearchJournal& journal, Progress& progress, SearchReport& report);

}  // namespace clearway
