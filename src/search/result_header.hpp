#pragma once

#include "clearway/query.hpp"
#include "clearway/search.hpp"
#include "io/result/result.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {

/// The header of the result of a search. For a shard, the part is still missing.
ResultHeader result_header(const StoreReader& store, const Query& query,
                           const SearchOptions& options);

}  // namespace clearway
