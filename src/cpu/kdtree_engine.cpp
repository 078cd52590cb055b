#include "cpu/kdtree_engine.hpp"

namespace clearway {

KdTreeEngine::KdTreeEngine(const PackedCloud& cloud, const SpheresOnPath& path,
                           const SlotLayout& layout)
    : blocks_per_cell_(cloud.blocks_per_cell()),
      pool_(cloud, path.query, layout),
      results_(layout.slots) {
  for (std::uint32_t slot = 0; slot < layout.slots; ++slot) searches_.emplace_back(cloud, path);
}

void KdTreeEngine::start(std::uint32_t slot, const PageShape& shape) {
  const Clock::time_point begin = Clock::now();
  const PageRef page{pool_.page(slot).data(), shape};
  for (std::uint32_t i = 0; i < shape.cells; ++i) {
    searches_[slot].search(page, i, part_of_cell(pool_.hits(slot), i, blocks_per_cell_));
  }
  results_[slot] = pool_.result(slot, shape.cells);
  results_[slot].compute = {begin, Clock::now()};
}

std::uint64_t KdTreeEngine::tested_searches() const {
  std::uint64_t searches = 0;
  for (const RangeSearch& search : searches_) searches += search.tested_searches();
  return searches;
}

std::uint64_t KdTreeEngine::slot_bytes(const PackedCloud& cloud, const SpheresOnPath& path,
                                       const SlotLayout& layout) {
  return PagePool::slot_bytes(cloud, path.query, layout) + RangeSearch::most_bytes(cloud, path);
}

}  // namespace clearway
