#pragma once

#include "search/engines.hpp"

namespace clearway {

/// run_engine for engine kdtree; options.threads is not 0.
SearchResult run_kdtree_engine(const StoreReader& store, const Query& query,
                               const EngineOptions& options, SearchJournal& journal,
                               Progress& progress, EngineReport& report);

}  // namespace clearway
