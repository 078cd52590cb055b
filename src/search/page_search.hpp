#pragma once

#include <cstdint>
#include <functional>

#include "core/query/search_result.hpp"
#include "core/util/progress.hpp"
#include "io/store/store_reader.hpp"
#include "search/kinds/page_engine_kind.hpp"
#include "search/shard/shard_cells.hpp"
#include "stream/search_journal.hpp"

namespace clearway {

/// What was found, and what of the memory is left to write it with, beside an engine that is still
/// being taken down.
struct Found {
  SearchResult result;
  std::uint64_t write_bytes = 0;
  EngineEnd engine_end = {};
};

/// Plans the query, or of it the cells `only`, within options.memory_bytes, makes the engine and,
/// with the journal that is then asked for, runs it. Throws ResourceError, before the journal is
/// asked for, naming the smallest budget that works.
Found search_pages(const StoreReader& store, const Query& query, std::uint64_t memory_bytes,
                   PageEngineKind& kind, const ShardCells* only,
                   const std::function<SearchJournal*()>& open_journal, Progress& progress,
                   SearchReport& report, const MessageLog& log);

}  // namespace clearway
