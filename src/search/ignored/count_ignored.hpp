#pragma once

#include "clearway/ignored.hpp"
#include "clearway/query.hpp"
#include "core/util/message_log.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {

/// Counts what the query leaves out of the whole store. query: one whose lists sort_ignored() has
/// sorted. Reads the points of cells that a box cuts, and where classes are named also the classes
/// of cells that a box touches. Throws UsageError where classes are named and the store has none,
/// and InputError where a cell is damaged.
IgnoredPointCounts count_ignored(const StoreReader& store, const QueryParameters& query,
                                 int threads);

/// Warns of classes and boxes that leave nothing out: "absent-class", "empty-box". Warns too where
/// they leave out all points or nearly all: "all-ignored", "most-ignored".
void warn_of_ignored(const StoreReader& store, const QueryParameters& query,
                     const IgnoredPointCounts& counts, MessageLog& log);

}  // namespace clearway
