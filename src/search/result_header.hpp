#pragma once

#include "clearway/query.hpp"
#include "clearway/search.hpp"
#include "io/result/result.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {

/// Of the result of a search, but for the part that it may be.
ResultHeader result_header(const StoreReader& store, const Query& query,
                           const SearchOptions& options);

}  // namespace clearway
