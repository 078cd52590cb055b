#include "cpu/sweep_engine.hpp"

#include "core/cloud/kd_order.hpp"

namespace clearway {
SweepEngine::SweepEngine(const PackedCloud& cloud, const SweepFilter& filter,
                         const SlotLayout& layout)
    : cloud_(cloud),
      filter_(filter),
      pool_(cloud, filter.query(), layout),
      results_(layout.slots) {}

void SweepEngine::start(std::uint32_t slot, const PageShape& shape) {
  const Clock::time_point begin = Clock::now();
  const PageRef page{pool_.page(slot).data(), shape};
  const std::size_t blocks = cloud_.blocks_per_cell(), slots = cloud_.cell_entries();
  std::unique_ptr<CellSearch> search = take_search();
  for (std::uint32_t i = 0; i < shape.cells; ++i) {
    search->run(
        page, i,
        {part_of_cell(pool_.hits(slot), i, blocks), part_of_cell(pool_.first_poses(slot), i, slots),
         part_of_cell(pool_.clearances(slot), i, slots)});
  }
  give_back(std::move(search));
  results_[slot] = pool_.result(slot, shape.cells);
  results_[slot].compute = {begin, Clock::now()};
}

std::unique_ptr<CellSearch> SweepEngine::take_search() {
  const std::lock_guard lock(mutex_);
  if (idle_.empty()) return std::make_unique<CellSearch>(cloud_, filter_);
  std::unique_ptr<CellSearch> search = std::move(idle_.back());
  idle_.pop_back();
  return search;
}

void SweepEngine::give_back(std::unique_ptr<CellSearch> search) {
  const std::lock_guard lock(mutex_);
  statistics_.add(search->take_statistics());
  idle_.push_back(std::move(search));
}

}  // namespace clearway
