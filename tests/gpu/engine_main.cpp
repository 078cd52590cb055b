// The engines' suite with the CUDA engines in place of the CPU's. Skips where there is no device.
#include "catch_session.hpp"
#include "gpu/beam_engine.hpp"
#include "gpu/devices.hpp"
#include "gpu/grid_engine.hpp"
#include "gpu/kept_on_device.hpp"
#include "gpu/section_engine.hpp"
#include "gpu/sweep_engine.hpp"
#include "stream/plan.hpp"
#include "stream/run_pages.hpp"
#include "support/catch.hpp"
#include "support/engines/engines.hpp"
#include "support/engines/grid_runs.hpp"
#include "support/engines/page_runs.hpp"
#include "support/engines/sweep_runs.hpp"

namespace clearway {
namespace {

SearchResult grid_on_cuda(const PackedCloud& cloud, const Query& query, int threads) {
  const auto slots = 1 + static_cast<std::uint32_t>(cloud.cells().size() % 3);
  return run_grid(cloud, query, {.slots = slots, .threads = threads},
                  [&](const GridScene& scene, const SlotLayout& layout, const RunIn& run_in) {
                    CudaGridEngine engine(0, scene, layout);
                    CHECK(engine.slots() == slots);
                    CHECK(engine.device_bytes() ==
                          cuda_grid_bytes(scene) + slots * cuda_grid_slot_bytes(scene, layout));
                    return run_in(engine);
                  });
}

SearchResult sweep_on_cuda(const PackedCloud& cloud, const Query& query, int threads) {
  return run_sweep(
      cloud, query, threads,
      []<typename Element>(const SweepFilterOf<Element>& filter, const PackedCloud& of,
                           const SlotLayout& layout) {
        const SweepRefOf<Element>& sweep = filter.ref();
        auto engine = std::make_unique<CudaSweepEngineOf<Element>>(0, sweep, of, layout);
        CHECK(engine->device_bytes() ==
              cuda_sweep_bytes(sweep) + layout.slots * cuda_sweep_slot_bytes(sweep, of, layout));
        return engine;
      },
      true);
}

/// Searches twice with the same cells kept on the device, where there is room for about a half of
/// them, and returns the second answer.
SearchResult sweep_with_kept_cells(const PackedCloud& cloud, const Query& query, int threads) {
  std::uint64_t bytes = 0;
  for (std::uint32_t cell = 0; cell < cloud.cells().size(); ++cell) {
    bytes += ArrayRun::aligned(cloud.packed_bytes(cell) + kPagePadding);
  }
  const auto kept = std::make_shared<KeptOnDevice>(0, cloud, bytes + (1 << 12));
  const auto search = [&] {
    return run_sweep(
        cloud, query, threads,
        [&kept]<typename Element>(const SweepFilterOf<Element>& filter, const PackedCloud& of,
                                  const SlotLayout& layout) {
          const auto field = std::make_shared<int>();
          return CudaSweepEngineOf<Element>::of_kept(filter.ref(), field, of, layout, kept);
        },
        true);
  };
  search();
  return search();
}

/// Runs the cells of a cloud through an engine that answers nothing page by page.
void run_quietly(const PackedCloud& cloud, const std::vector<PlannedCell>& cells,
                 const SlotLayout& layout, const IgnoredPoints& ignored, PageEngine& engine) {
  PageEngine* const lane = &engine;
  NoProgress silent;
  StageTimes times;
  run_pages(
      cloud, cells, paginate(cloud, cells, layout.page_bytes, layout.cells, ignored.any()),
      {&lane, 1}, {.stage = "pages", .masks = ignored.any() ? &ignored : nullptr, .threads = 2},
      [](std::span<const PlannedCell>, const PageResult&) {}, silent, times);
}

BeamRun beams_on_cuda(const PackedCloud& cloud, const Beams& beams) {
  const std::vector<PlannedCell> cells = all_cells(cloud);
  const SlotLayout layout{2, smallest_page_bytes(cloud, cells) * kPageCells, kPageCells};
  CudaBeamEngine engine(0, beams, cloud, layout);
  CHECK(engine.device_bytes() ==
        cuda_beam_bytes(beams) + layout.slots * cuda_beam_slot_bytes(beams, cloud, layout));
  run_quietly(cloud, cells, layout, IgnoredPoints(cloud, {}), engine);
  return {engine.words(), engine.counts()};
}

void section_on_cuda(const PackedCloud& cloud, const IgnoredPoints& ignored,
                     const SectionRef& section) {
  const std::vector<PlannedCell> cells = section_cells(cloud, section);
  if (cells.empty()) return;
  const SlotLayout layout{2, smallest_page_bytes(cloud, cells, ignored.any()) * kPageCells,
                          kPageCells};
  CudaSectionEngine engine(0, section, cloud, layout);
  CHECK(engine.device_bytes() ==
        cuda_section_bytes(section) + layout.slots * cuda_section_slot_bytes(cloud, layout));
  run_quietly(cloud, cells, layout, ignored, engine);
  engine.read_entries({section.entries, section.entry_count()});
}

}  // namespace
}  // namespace clearway

int main(int count, char** arguments) {
  clearway::engines() = {{"sweep on CUDA", clearway::sweep_on_cuda, true},
                         {"sweep on CUDA with kept cells", clearway::sweep_with_kept_cells, true},
                         {"grid on CUDA", clearway::grid_on_cuda, false}};
  clearway::follow_pages = clearway::beams_on_cuda;
  clearway::block_pages = clearway::section_on_cuda;
  return run_catch(count, arguments, [] {
    return clearway::cuda_device_count() == 0 ? "no CUDA device here" : nullptr;
  });
}
