#pragma once

#include <cstdint>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/ignored.hpp"
#include "clearway/query.hpp"
#include "core/messages/messages.hpp"
#include "io/scans/length_unit.hpp"
#include "io/store/store_reader.hpp"
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

/// The height in the model's frame that no ground reaches: well above its lowest point.
double above_ground(const StoreReader& store, const Query& query);

/// Those of the colliding points of a cell that are higher than `above` when they are first
/// touched, in the frame of the body that touches them. colliding: with first poses.
CellRows high_points(const StoreReader& store, const Query& query, double above, std::uint32_t cell,
                     const CellRows& colliding);

/// Warns where ignoring points may have made the answer: "ignored-collide" where more ignored
/// points would collide than searched ones do, and "ignored-high" where some would collide well
/// above the ground. Both are known only after the search, so strict calls do not refuse them.
/// With a floor the number alone is no reason. unit: the environment's.
void warn_of_colliding_ignored(const Answer& answer, LengthUnit unit, MessageLog& log);

}  // namespace clearway
