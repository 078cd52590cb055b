#include "support/engines/section_runs.hpp"

#include <span>
#include <vector>

#include "core/section/section_block.hpp"
#include "stream/plan.hpp"
#include "stream/run_pages.hpp"
#include "support/engines/page_memory.hpp"

namespace clearway {
namespace {

void block_on_host(const PackedCloud& cloud, const IgnoredPoints& ignored,
                   const SectionRef& section) {
  const std::vector<PlannedCell> cells = section_cells(cloud, section);
  for (const PlannedPage& planned :
       paginate(cloud, cells, 1 << 20, kSectionPageCells, ignored.any())) {
    test::PageMemory memory(planned.shape.bytes());
    const std::span<std::byte> bytes = memory.bytes();
    std::uint64_t left_out = 0;
    const PageShape shape = stage_page(cloud, planned.of(cells), bytes, ignored, left_out);
    const SectionPage page{section, {bytes.data(), shape}, cloud.quantisation()};
    for (std::uint32_t block = 0; block < page.block_count(); ++block) {
      SectionBlock<HostWarp>(page, block).search();
    }
  }
}

auto block = block_on_host;

}  // namespace

std::vector<PlannedCell> section_cells(const PackedCloud& cloud, const SectionRef& section) {
  std::vector<PlannedCell> cells;
  for (std::uint32_t cell = 0; cell < cloud.cells().size(); ++cell) {
    auto bins = bins_in_reach(section, position_box(cloud.quantisation(), cloud.cells()[cell].box));
    if (!bins.empty()) cells.push_back({cell, std::move(bins)});
  }
  return cells;
}

void block_pages(const PackedCloud& cloud, const IgnoredPoints& ignored,
                 const SectionRef& section) {
  block(cloud, ignored, section);
}

void block_pages_with(void (*run)(const PackedCloud& cloud, const IgnoredPoints& ignored,
                                  const SectionRef& section)) {
  block = run;
}

}  // namespace clearway
