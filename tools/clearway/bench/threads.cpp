// Fig. 1: speed by the number of threads.
#include <tbb/info.h>

#include "clearway/bench/bench.hpp"

namespace clearway::tool {
void bench_threads(Bench& bench) {
  // Large enough to keep all threads busy.
  const bool small = bench.options().size == "small";
  const SceneFiles files = bench.scene("hall", small ? "tenth" : bench.options().size);
  const int cores = tbb::info::default_concurrency();
  const int step = cores > 8 ? cores / 8 : 1;
  for (const std::string name : {"kdtree cpu", "sweep cpu"}) {
    const auto measure = [&](int threads) {
      const EngineChoice engine = bench.engine(name).with({"--threads", std::to_string(threads)});
      bench.measure(name + "/" + std::to_string(threads) + " threads",
                    {{"scene", "hall"}, {"engine", name}, {"threads", threads}}, files,
                    engine.options);
    };
    measure(1);
    for (int threads = step == 1 ? 2 : step; threads <= 2 * cores; threads += step)
      measure(threads);
  }
}

}  // namespace clearway::tool
