#include "stream/collect_page.hpp"

#include <cassert>

namespace clearway {
void collect_page(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                  const PageResult& answer, SearchResult& all) {
  assert(answer.hits.size() == cells.size() * cloud.blocks_per_cell());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto hits = part_of_cell(answer.hits, i, cloud.blocks_per_cell());
    const std::uint64_t first_word = std::uint64_t{cells[i].cell} * cloud.blocks_per_cell();
    for (std::size_t block = 0; block < hits.size(); ++block) {
      if (hits[block] != 0) all.hits.mark_word(first_word + block, hits[block]);
    }
    const std::uint64_t first_entry = std::uint64_t{cells[i].cell} * cloud.cell_entries();
    const auto poses = part_of_cell(answer.first_poses, i, cloud.cell_entries());
    for (std::size_t entry = 0; entry < poses.size(); ++entry) {
      if (poses[entry] != HitSet::kNever) all.hits.mark(first_entry + entry, poses[entry]);
    }
    const auto clearances = part_of_cell(answer.clearances, i, cloud.cell_entries());
    for (std::size_t entry = 0; entry < clearances.size(); ++entry) {
      if (clearances[entry].found()) all.clearances.set(first_entry + entry, clearances[entry]);
    }
  }
}

}  // namespace clearway
