#include "support/engines/page_runs.hpp"

#include "core/section/section_block.hpp"
#include "stream/plan.hpp"

namespace clearway {
namespace {

BeamRun follow_on_host(const PackedCloud& cloud, const Beams& beams) {
  BeamRun run{{beams.map.words().begin(), beams.map.words().end()}, {}};
  BeamsRef ref = beams.ref;
  ref.map.words = run.words.data();
  const std::vector<PlannedCell> cells = all_cells(cloud);
  for (const PlannedPage& planned : paginate(cloud, cells, 1 << 20, kPageCells)) {
    PageMemory page(planned.shape.bytes());
    PageMemory origins(
        origin_bytes(planned.shape.cells, cloud.cell_points(), beams.origin_minbits));
    const PageRef staged{page.bytes().data(), stage_page(cloud, planned.of(cells), page.bytes())};
    stage_origins(staged, beams.origins_of, origins.bytes().data());
    const BeamPage follows{staged, {origins.bytes().data(), {}}};
    for (std::uint32_t cell = 0; cell < planned.shape.cells; ++cell) {
      for (std::uint32_t i = 0; i < cloud.cell_entries(); ++i) {
        follows.follow(ref, cell, i, run.left_out);
      }
    }
  }
  return run;
}

void block_on_host(const PackedCloud& cloud, const IgnoredPoints& ignored,
                   const SectionRef& section) {
  const std::vector<PlannedCell> cells = section_cells(cloud, section);
  for (const PlannedPage& planned : paginate(cloud, cells, 1 << 20, kPageCells, ignored.any())) {
    PageMemory memory(planned.shape.bytes());
    const PageShape shape =
        stage_page(cloud, planned.of(cells), memory.bytes(), ignored.any() ? &ignored : nullptr);
    const SectionPage page{section, {memory.bytes().data(), shape}, cloud.quantisation()};
    for (std::uint32_t block = 0; block < page.block_count(); ++block) {
      SectionBlock<HostWarp>(page, block).search();
    }
  }
}

}  // namespace

BeamRun (*follow_pages)(const PackedCloud& cloud, const Beams& beams) = follow_on_host;
void (*block_pages)(const PackedCloud& cloud, const IgnoredPoints& ignored,
                    const SectionRef& section) = block_on_host;

std::vector<PlannedCell> all_cells(const PackedCloud& cloud) {
  std::vector<PlannedCell> cells;
  for (std::uint32_t cell = 0; cell < cloud.cells().size(); ++cell) cells.push_back({cell, {}});
  return cells;
}

std::vector<PlannedCell> section_cells(const PackedCloud& cloud, const SectionRef& section) {
  std::vector<PlannedCell> cells;
  for (std::uint32_t cell = 0; cell < cloud.cells().size(); ++cell) {
    auto bins = bins_in_reach(section, position_box(cloud.quantisation(), cloud.cells()[cell].box));
    if (!bins.empty()) cells.push_back({cell, std::move(bins)});
  }
  return cells;
}

}  // namespace clearway
