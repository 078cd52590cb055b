#include "support/engines/answer_sets.hpp"

#include "core/util/lane_bits.hpp"

namespace clearway {

SearchResult empty_result(const PackedCloud& cloud, const Query& query) {
  return {HitSet(cloud.entry_count(), query.first_pose),
          std::vector<Clearance>(query.clearance > 0 ? cloud.entry_count() : 0),
          query.profile > 0 ? ProfileSet(cloud, query.poses.size()) : ProfileSet()};
}

void add_page(const PackedCloud& cloud, std::span<const PlannedCell> cells, const PageResult& page,
              SearchResult& all) {
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::uint64_t first = std::uint64_t{cells[i].cell} * cloud.cell_entries();
    const auto hits = part_of_cell(page.hits, i, cloud.blocks_per_cell());
    for (std::size_t block = 0; block < hits.size(); ++block) {
      for_each_bit(hits[block],
                   [&](std::uint32_t bit) { all.hits.mark(first + block * kBlockPoints + bit); });
    }
    const auto poses = part_of_cell(page.first_poses, i, cloud.cell_entries());
    for (std::size_t entry = 0; entry < poses.size(); ++entry) {
      if (poses[entry] != kNoPose) all.hits.mark(first + entry, poses[entry]);
    }
    const auto clearances = part_of_cell(page.clearances, i, cloud.cell_entries());
    for (std::size_t entry = 0; entry < clearances.size(); ++entry) {
      if (clearances[entry].found()) all.clearances[first + entry] = clearances[entry];
    }
  }
  offer_profile(cloud, cells, page.profile, all.profile);
}

SearchResult result_of(const AnswerRows& rows, const PackedCloud& cloud, ProfileSet profile) {
  SearchResult all = empty_result(cloud, rows.query());
  for (std::uint32_t cell = 0; cell < cloud.cells().size(); ++cell) {
    const std::uint64_t first = std::uint64_t{cell} * cloud.cell_entries();
    const CellRows hits = rows.read(cell, PointQuestion::kHits);
    hits.for_each([&](std::uint32_t point, std::size_t row) {
      all.hits.mark(first + point);
      if (!hits.poses.empty()) all.hits.mark(first + point, hits.poses[row]);
    });
    const CellRows clearances = rows.read(cell, PointQuestion::kClearances);
    clearances.for_each([&](std::uint32_t point, std::size_t row) {
      all.clearances[first + point] = {clearances.distances[row], clearances.poses[row]};
    });
  }
  all.profile = std::move(profile);
  return all;
}

SearchResult run_pages(const PackedCloud& cloud, std::span<const PlannedCell> cells,
                       std::span<const PlannedPage> pages, std::span<PageEngine* const> engines,
                       const Query& query, int threads, Progress& progress, StageTimes& times) {
  SearchResult answer = empty_result(cloud, query);
  const IgnoredPoints ignored(cloud, query);
  run_pages(
      cloud, cells, pages, engines,
      {.masks = ignored.any() ? &ignored : nullptr, .threads = threads},
      [&](std::span<const PlannedCell> of, const PageResult& found) {
        add_page(cloud, of, found, answer);
      },
      progress, times);
  return answer;
}

}  // namespace clearway
