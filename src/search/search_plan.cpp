#include "search/search_plan.hpp"

#include <algorithm>

#include "core/sweep/tolerance.hpp"
#include "core/util/stopwatch.hpp"
#include "cpu/cell_search.hpp"
#include "stream/paginate.hpp"
#include "stream/plan.hpp"

namespace clearway {

SearchPlan::SearchPlan(const StoreReader& cloud, const Query& query, const QueryTrees& trees,
                       const ModelFieldOptions& field_options, int threads, const Stopwatch& clock)
    : store(cloud),
      field(trees.model, search_radius(query), field_options, threads),
      field_seconds(clock.seconds()),
      filter(query, trees.motion, trees.model, field, cloud),
      cells(plan(cloud, filter)),
      plan_seconds(clock.seconds() - field_seconds) {}

std::uint64_t SearchPlan::allocated_bytes() const {
  constexpr std::uint64_t kHeapBlock = 16;
  // While cells are sorted, half of them are there twice.
  std::uint64_t bytes = field.allocated_bytes() + 3 * cells.capacity() * sizeof(PlannedCell) / 2;
  for (const PlannedCell& cell : cells) {
    bytes += cell.nodes.capacity() * sizeof(std::uint32_t) + kHeapBlock;
  }
  return bytes;
}

std::uint64_t SearchPlan::least_page_bytes() const { return smallest_page_bytes(store, cells); }

std::uint64_t SearchPlan::most_poses() const {
  std::uint64_t most = 0;
  for (const PlannedCell& cell : cells)
    most = std::max(most, pose_count(filter.motion(), cell.nodes));
  return most;
}

}  // namespace clearway
