// How evenly work is divided among 16 shards: the largest shard's work over the mean.
#include <algorithm>
#include <cstdio>
#include <numeric>

#include "bench/experiments/bench.hpp"
#include "clearway/error.hpp"
#include "cli/support/console.hpp"

namespace clearway::bench {
namespace {

constexpr int kShards = 16;

struct ShardMode {
  const char* name;
  std::vector<std::string> options;
};

/// The largest value over the mean; 1 where there is nothing to divide.
double unevenness(const std::vector<double>& of_shards) {
  const double sum = std::accumulate(of_shards.begin(), of_shards.end(), 0.0);
  return sum > 0 ? *std::ranges::max_element(of_shards) * kShards / sum : 1;
}

class ShardBalance {
 public:
  explicit ShardBalance(Bench& bench) : bench_(bench) {}

  void scene(const std::string& name, const SceneFiles& files) {
    static const ShardMode kModes[]{{"set", {}},
                                    {"first poses", {"--first-pose"}},
                                    {"clearances", {"--clearance", "0.3"}},
                                    {"profile", {"--profile", "0.5"}}};
    for (const ShardMode& mode : kModes) measure(name, mode, files);
  }

  void finish() const {
    bench_.conclude({{"worst_set", worst_set_}, {"worst", worst_}, {"worst_case", worst_case_}});
  }

 private:
  /// Measures the work of each shard: the time in which the engine computes, of the fastest run.
  /// One thread, because with more the last cell of a shard would count as work of all.
  void measure(const std::string& scene, const ShardMode& mode, const SceneFiles& files) {
    std::vector<double> estimated, computed;
    for (int shard = 1; shard <= kShards; ++shard) {
      const std::string text = std::to_string(shard) + "/" + std::to_string(kShards);
      std::vector<std::string> options{"--engine", "sweep", "--radius", "0.1", "--shard", text};
      if (bench_.cuda()) {
        options.insert(options.end(), {"--device", "cuda"});
      } else {
        options.insert(options.end(), {"--device", "cpu", "--threads", "1"});
      }
      options.insert(options.end(), mode.options.begin(), mode.options.end());
      const Json made =
          bench_.measure(scene + ", " + mode.name + "/" + text,
                         {{"scene", scene}, {"mode", mode.name}, {"shard", text}}, files, options);
      if (made.contains("failed")) return;
      estimated.push_back(made["runs"][0]["shard_share"]);
      double least = made["runs"][0]["seconds"]["compute"];
      for (const Json& run : made["runs"]) {
        least = std::min(least, run["seconds"]["compute"].get<double>());
      }
      computed.push_back(least);
    }
    print_estimate(scene, mode, estimated, computed);
  }

  void print_estimate(const std::string& scene, const ShardMode& mode,
                      const std::vector<double>& estimated, const std::vector<double>& computed) {
    const double mean = std::accumulate(computed.begin(), computed.end(), 0.0) / kShards;
    const double uneven = unevenness(computed);
    const std::string name = scene + ", " + mode.name;
    bench_.keep(name, {{"scene", scene}, {"mode", mode.name}}, [&]() -> Json {
      return {{"estimated", unevenness(estimated)}, {"computed", uneven}, {"mean_seconds", mean}};
    });
    char text[160];
    std::snprintf(text, sizeof text,
                  "%s: the largest of %d shards has %.2f times the mean by estimate, %.2f times "
                  "measured (mean %.3f s)\n",
                  name.c_str(), kShards, unevenness(estimated), uneven, mean);
    tool::print(text);
    if (mode.options.empty()) worst_set_ = std::max(worst_set_, uneven);
    if (uneven <= worst_) return;
    worst_ = uneven;
    worst_case_ = name;
  }

  Bench& bench_;
  double worst_set_ = 0, worst_ = 0;
  std::string worst_case_;
};

}  // namespace

void bench_shards(Bench& bench) {
  ShardBalance balance(bench);
  for (const std::string& scene : bench.options().scenes) {
    balance.scene(scene, bench.scene(scene));
  }
  if (!bench.options().also.store.empty()) balance.scene("given", bench.options().also);
  balance.finish();
}

}  // namespace clearway::bench
