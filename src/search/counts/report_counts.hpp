#pragma once

#include "clearway/search.hpp"
#include "io/result/result.hpp"
#include "io/store/store_reader.hpp"

/// Fills in what the report of a search counts.
namespace clearway {

/// Fills in how much there is to search.
void report_sizes(const StoreReader& store, const Query& query, SearchReport& report);

/// Fills in the answer of a result that was complete already.
void report_finished(const ResultReader& result, SearchReport& report);

}  // namespace clearway
