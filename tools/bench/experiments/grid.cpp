// Fig. 2: time of each step by grid resolution, in the adaptive layout and the paper's regular one.
#include "bench/experiments/bench.hpp"
#include "bench/stages/set_engines.hpp"

namespace clearway::bench {
namespace {

constexpr const char* kGridCells[] = {"0.04", "0.05", "0.07", "0.1", "0.14", "0.2", "0.28", "0.4"};
constexpr const char* kCellPoints[] = {"1024", "4096", "16384", "65536", "262144"};
/// Edge of a regular cell, metres.
constexpr const char* kCellSizes[] = {"0.7", "1", "1.5", "2", "3", "5", "8", "12", "20"};
/// Points of a chunk of the regular layout. A cell has as many chunks as it needs, the last one
/// padded.
constexpr int kRegularChunk = 4096;

}  // namespace

void bench_grid(Bench& bench) {
  const SceneFiles hall = bench.scene("hall");
  const EngineChoice engine = bench.engine_here("grid");
  bench.measure("grid cell/chosen", {{"vary", "grid cell"}, {"value", "chosen"}}, hall,
                engine.with({kPrecisionOption, "exact"}).options);
  for (const char* size : kGridCells) {
    bench.measure(std::string("grid cell/") + size, {{"vary", "grid cell"}, {"value", size}}, hall,
                  engine.with({kGridCellOption, size}).options);
  }
  const std::string name = "hall-" + bench.options().size;
  for (const char* points : kCellPoints) {
    SceneFiles files = hall;
    files.store =
        bench.store(name + "-cells-" + points, hall.environment, {"--cell-points", points});
    bench.measure(std::string("adaptive layout/") + points,
                  {{"vary", "adaptive layout"}, {"value", points}}, files, engine.options);
  }
  for (const char* size : kCellSizes) {
    SceneFiles files = hall;
    files.store = bench.store(name + "-regular-" + size, hall.environment,
                              {"--layout", std::string("regular:") + size, "--cell-points",
                               std::to_string(kRegularChunk)});
    bench.measure(std::string("regular layout/") + size,
                  {{"vary", "regular layout"}, {"value", size}, {"chunk_points", kRegularChunk}},
                  files, engine.options, {}, {}, Refusal::kMemory);
  }
}

}  // namespace clearway::bench
