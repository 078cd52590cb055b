#include "stream/run_cells.hpp"

#include <tbb/global_control.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

namespace clearway {
namespace {

/// Cells are disjoint and a block is a word, so collecting needs no order.
void collect(const CellAnswer& answer, const PackedCloud& cloud, Answer& all) {
  const std::uint64_t first_word = std::uint64_t{answer.cell} * cloud.blocks_per_cell();
  for (std::size_t block = 0; block < answer.hits.size(); ++block) {
    if (answer.hits[block] != 0) all.hits.mark_word(first_word + block, answer.hits[block]);
  }
  const std::uint64_t first_slot = std::uint64_t{answer.cell} * cloud.cell_slots();
  for (std::size_t slot = 0; slot < answer.first_poses.size(); ++slot) {
    if (answer.first_poses[slot] != HitSet::kNever) {
      all.hits.mark(first_slot + slot, answer.first_poses[slot]);
    }
  }
  for (std::size_t slot = 0; slot < answer.clearances.size(); ++slot) {
    const Clearance& clearance = answer.clearances[slot];
    if (clearance.found()) all.clearances.set(first_slot + slot, clearance);
  }
}

}  // namespace

Answer run_cells(const PackedCloud& cloud, const std::vector<PlannedCell>& cells,
                 CellEngine& engine, const Question& question, int threads, Progress& progress) {
  Answer answer{HitSet(cloud.slot_count(), question.first_pose),
                ClearanceSet(question.clearance > 0 ? cloud.slot_count() : 0)};
  std::uint64_t points = 0;
  for (const PlannedCell& cell : cells) points += cloud.cells()[cell.cell].count;
  if (threads == 0) threads = tbb::this_task_arena::max_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  progress.begin("search", points, "points");
  std::size_t next = 0;
  tbb::parallel_pipeline(
      static_cast<std::size_t>(threads) + 1,
      tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order,
                                          [&](tbb::flow_control& flow) {
                                            if (next == cells.size()) flow.stop();
                                            return next++;
                                          }) &
          tbb::make_filter<std::size_t, void>(tbb::filter_mode::parallel, [&](std::size_t i) {
            collect(engine.search(cells[i]), cloud, answer);
            progress.advance(cloud.cells()[cells[i].cell].count);
          }));
  progress.end();
  return answer;
}

}  // namespace clearway
