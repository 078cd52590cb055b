#include "stream/collect_page.hpp"

#include <cassert>

namespace clearway {

std::uint64_t entry_of(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                       std::uint32_t point) {
  return std::uint64_t{cells[point / cloud.cell_entries()].cell} * cloud.cell_entries() +
         point % cloud.cell_entries();
}

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
  for (const ProfileFact& fact : answer.profile) {
    const std::uint64_t entry = entry_of(cloud, cells, fact.point);
    const auto index = static_cast<std::uint32_t>(fact.point % cloud.cell_entries());
    const std::uint32_t cell = cells[fact.point / cloud.cell_entries()].cell;
    all.profile.offer(fact.pose, {fact.squared, cloud.source_of(cell, index), entry});
  }
}

}  // namespace clearway
