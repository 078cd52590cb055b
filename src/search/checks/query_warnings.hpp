#pragma once

#include "clearway/query.hpp"
#include "core/util/message_log.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {

/// Warns where a query may answer something else than was meant, because of a path in another
/// frame, a model in another unit, or steps that skip things. Reads the store's index, and the
/// points below a few poses. The model is not empty. Deterministic.
void warn_of_query(const StoreReader& store, const Query& query, MessageLog& log);

}  // namespace clearway
