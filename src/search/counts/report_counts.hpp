#pragma once

#include "clearway/search.hpp"
#include "core/query/profile_set.hpp"
#include "io/result/result.hpp"
#include "io/store/store_reader.hpp"
#include "stream/write_result.hpp"

/// What a report of a search counts.
namespace clearway {

/// How much there is to search.
void report_sizes(const StoreReader& store, const Query& query, SearchReport& report);

/// Of a result that was there already.
void report_finished(const ResultReader& result, SearchReport& report);

/// Of one that was written now.
void report_written(const WrittenResult& written, const ProfileSet& profile, SearchReport& report);

}  // namespace clearway
