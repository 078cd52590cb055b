// Every engine on the four scenes: Table 1 (colliding points) and Fig. 3 (time).
#include "bench/experiments/bench.hpp"
#include "bench/measure/scoring.hpp"

namespace clearway::bench {
namespace {

/// The engines that decide exactly, and float alone as the paper's GPU method.
std::vector<EngineChoice> engines_of_table(const Bench& bench) {
  std::vector<EngineChoice> engines = bench.exact_engines();
  engines.push_back(bench.engine_here("grid float"));
  return engines;
}

}  // namespace

void bench_table(Bench& bench) {
  WrongCases wrong;
  const auto measure = [&](const std::string& scene, const SceneFiles& files) {
    const auto reference =
        bench.answer("reference-" + scene, files, bench.engine("sweep cpu").options);
    for (const EngineChoice& engine : engines_of_table(bench)) {
      const Json found = bench.measure(
          scene + "/" + engine.name,
          {{"scene", scene}, {"engine", engine.name}, {"exact", engine.exact}}, files,
          engine.options,
          [&](const std::filesystem::path& result) { return compared(result, reference); });
      if (engine.exact) wrong.look_at(found);
    }
  };
  const SceneFiles& own = bench.options().also;
  if (own.store.empty()) {
    for (const std::string& scene : bench.options().scenes) measure(scene, bench.scene(scene));
  } else {
    measure(own.store.stem().string(), own);
  }
  wrong.refuse();
}

}  // namespace clearway::bench
