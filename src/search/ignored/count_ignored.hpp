#pragma once

#include "clearway/ignored.hpp"
#include "clearway/query.hpp"
#include "core/util/message_log.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {

/// What the query leaves out of the whole store. query: its lists as sort_ignored() leaves them.
/// Reads points of cells that a box cuts, and with classes named the classes of cells that a box
/// touches. Throws UsageError where classes are named and the store has none, InputError for a
/// damaged cell.
IgnoredPointCounts count_ignored(const StoreReader& store, const QueryParameters& query,
                                 int threads);

/// Warns of what leaves nothing out: "absent-class", "empty-box"; and where that is all there is,
/// or nearly so: "all-ignored", "most-ignored".
void warn_of_ignored(const StoreReader& store, const QueryParameters& query,
                     const IgnoredPointCounts& counts, MessageLog& log);

}  // namespace clearway
