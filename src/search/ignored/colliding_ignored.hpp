#pragma once

#include <cstdint>
#include <vector>

#include "clearway/answer.hpp"
#include "clearway/query.hpp"
#include "core/util/message_log.hpp"
#include "core/util/progress.hpp"
#include "io/formats/length_unit.hpp"
#include "io/store/store_reader.hpp"
#include "search/kinds/page_engine_kind.hpp"
#include "search/shard/shard_cells.hpp"

/// How many of the points that a query ignores would collide: a second search, of them alone.
namespace clearway {

/// Counts of ignored points, and what counting them took.
struct CollidingIgnored {
  std::uint64_t points = 0;  ///< that would collide
  std::uint64_t high = 0;    ///< those first touched well above the model's lowest point
  std::uint64_t needed_host_bytes = 0, peak_device_bytes = 0;
};

/// The query as the second search asks it: exact, with first poses and without distances.
Query query_of_ignored(const Query& query);

/// Searches the ignored points of all cells, or of those of `only`. query: as query_of_ignored()
/// makes it, and kind: of it. The numbers do not depend on the kind. Throws as search_pages does.
CollidingIgnored count_colliding_ignored(const StoreReader& store, const Query& query,
                                         std::uint64_t memory_bytes, PageEngineKind& kind,
                                         const ShardCells* only, Progress& progress);

/// Warns where ignoring points may have made the answer: "ignored-collide" where more of them would
/// collide than of the searched ones, and "ignored-high" where some would well above the ground.
/// Both are known only after the search, so strict calls do not refuse them. model_is_cut: as
/// SearchOptions has it. unit: of the environment.
void warn_of_colliding_ignored(const Answer& answer, bool model_is_cut, LengthUnit unit,
                               MessageLog& log);

}  // namespace clearway
