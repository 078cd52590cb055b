#include "support/engines/beam_runs.hpp"

#include <algorithm>
#include <span>

#include "stream/plan.hpp"
#include "stream/run_pages.hpp"
#include "support/engines/page_memory.hpp"

namespace clearway {
namespace {

BeamRun follow_on_host(const PackedCloud& cloud, const Beams& beams) {
  BeamRun run{{beams.map.words().begin(), beams.map.words().end()}, {}};
  BeamsRef ref = beams.ref;
  ref.map.words = run.words.data();
  std::vector<PlannedCell> cells;
  for (std::uint32_t cell = 0; cell < cloud.cells().size(); ++cell) cells.push_back({cell, {}});
  for (const PlannedPage& planned : paginate(cloud, cells, 1 << 20, kBeamPageCells)) {
    test::PageMemory page(planned.shape.bytes());
    test::PageMemory origins(
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

auto follow = follow_on_host;

}  // namespace

BeamRun follow_pages(const PackedCloud& cloud, const Beams& beams) { return follow(cloud, beams); }

void follow_pages_with(BeamRun (*run)(const PackedCloud& cloud, const Beams& beams)) {
  follow = run;
}

}  // namespace clearway
