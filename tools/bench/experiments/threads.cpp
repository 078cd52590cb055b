// Fig. 1: speed against the number of threads.
#include <tbb/info.h>

#include "bench/experiments/bench.hpp"
#include "bench/experiments/thread_counts.hpp"

namespace clearway::bench {
void bench_threads(Bench& bench) {
  // The scene is large enough to keep all threads busy.
  const bool small = bench.options().size == "small";
  const SceneFiles files = bench.scene("hall", small ? "tenth" : bench.options().size);
  for (const std::string name : {"kdtree cpu", "sweep cpu"}) {
    for (const int threads : thread_counts(tbb::info::default_concurrency())) {
      const EngineChoice engine = bench.engine(name).with({"--threads", std::to_string(threads)});
      bench.measure(name + "/" + std::to_string(threads) + " threads",
                    {{"scene", "hall"}, {"engine", name}, {"threads", threads}}, files,
                    engine.options);
    }
  }
}

}  // namespace clearway::bench
