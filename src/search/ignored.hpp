#pragma once

#include <cstdint>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/ignored.hpp"
#include "clearway/query.hpp"
#include "core/messages/messages.hpp"
#include "core/util/progress.hpp"
#include "io/scans/length_unit.hpp"
#include "io/store/store_reader.hpp"
#include "search/kinds/page_engine_kind.hpp"
#include "search/shard_cells.hpp"
#include "search/visit.hpp"
#include "stream/answer_rows.hpp"

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

// How many of the points that a query ignores would collide: found by a second search, of these
// points alone.

/// The query of the second search: exact, with first poses and without distances.
Query query_of_ignored(const Query& query);

/// Searches the ignored points of all cells that `rows` does not know, or of those of `only`, and
/// adds to `rows` which of them would collide, and which of these are first touched well above the
/// model's lowest point. query: one made by query_of_ignored(). kind: the engine for that query.
/// Throws as run_visit() does.
SearchReport find_colliding_ignored(const StoreReader& store, const Query& query,
                                    std::uint64_t memory_bytes, PageEngineKind& kind,
                                    const ShardCells* only, AnswerRows& rows, Progress& progress);

/// Warns where ignoring points may have made the answer: "ignored-collide" where more ignored
/// points would collide than searched ones do, and "ignored-high" where some would collide well
/// above the ground. Both are known only after the search, so strict calls do not refuse them.
/// With a floor the number alone is no reason. unit: the environment's.
void warn_of_colliding_ignored(const Answer& answer, LengthUnit unit, MessageLog& log);

}  // namespace clearway
