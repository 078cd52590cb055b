#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "clearway/query.hpp"
#include "clearway/search.hpp"
#include "io/result/result.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {

/// Gives a query with an error budget but without a gap the usual gap of 0.3 m. metre: the length
/// of a metre in the environment's unit.
void choose_gap(QueryParameters& query, double metre);

/// The header of the result of a search. ignored: how many points the query leaves out, which is
/// asked with its lists sorted. model_hashes: hash_of_model() of the model, or of each body's. For
/// a shard, the part is still missing.
ResultHeader result_header(
    const StoreReader& store, const Query& query, std::span<const std::uint64_t> model_hashes,
    const std::function<IgnoredPointCounts(const QueryParameters& sorted)>& ignored);

/// Fills in how much there is to search.
void report_sizes(const StoreReader& store, const Query& query, SearchReport& report);

/// Fills in the answer of a result that was complete already. Warnings of the report stay, behind
/// those that the result keeps.
void report_finished(const ResultReader& result, SearchReport& report);

}  // namespace clearway
