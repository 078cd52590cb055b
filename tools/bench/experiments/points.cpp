// Fig. 4: time by the number of environment points, random samples of the hall.
#include "bench/experiments/bench.hpp"
#include "bench/variants/variants.hpp"

namespace clearway::bench {
namespace {

constexpr int kSamples = 37, kSamplesFull = 111;  ///< 111 as in the paper
constexpr int kStride = 40;  ///< step through the samples; the first part covers the range
constexpr std::uint64_t kSampleSeed = 4;

}  // namespace

void bench_points(Bench& bench) {
  const SceneFiles hall = bench.scene("hall");
  const std::uint64_t all = scene_size("hall", bench.options().size).points;
  const int samples = bench.full() ? kSamplesFull : kSamples;
  const std::uint64_t step = bench.full() ? 500'000 : all / kSamples;
  const std::filesystem::path sample = bench.work() / "sample.las";
  for (int k = 0; k < samples; ++k) {
    const int i = 1 + k * kStride % samples;
    const std::uint64_t points = step * static_cast<std::uint64_t>(i);
    SceneFiles files = hall;
    files.store = bench.work() / "sample.h5";
    bool made = false;
    for (const EngineChoice& engine : bench.exact_engines()) {
      const std::string key = engine.name + "/" + std::to_string(points);
      if (bench.find(key)) continue;
      if (!made) {
        std::filesystem::remove(files.store);
        sample_environment(hall.environment, sample, points,
                           kSampleSeed + static_cast<std::uint64_t>(i));
        bench.store("sample", sample);
        made = true;
      }
      bench.measure(key, {{"scene", "hall"}, {"engine", engine.name}, {"points", points}}, files,
                    engine.options, {}, 1);
    }
  }
  std::filesystem::remove(sample);
}

}  // namespace clearway::bench
