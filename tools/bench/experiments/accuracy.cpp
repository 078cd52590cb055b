// Time against wrongly decided points: exact engines, float alone, far origins, tolerances, thinned
// models and trajectories, coarser environments. The truth is the sweep's exact distances.
#include "bench/experiments/bench.hpp"
#include "bench/measure/scoring.hpp"
#include "bench/stages/set_engines.hpp"
#include "bench/variants/variants.hpp"

namespace clearway::bench {
namespace {

/// A UTM coordinate in whole metres, the farthest from the origin for which int32 at 0.1 mm and
/// offsets in metres are used.
constexpr Vec3 kUtm{450'000, 5'400'000, 0};
constexpr Vec3 kFar{10'000'000, 10'000'000, 0};

class Accuracy {
 public:
  explicit Accuracy(Bench& bench)
      : bench_(bench),
        hall_(bench.scene("hall")),
        fast_(bench.engine_here("sweep")),
        grid_(bench.engine_here("grid")),
        float_(bench.engine_here("grid float")),
        truth_(bench.truth("hall", hall_)) {}

  void engines() {
    for (const EngineChoice& engine : bench_.exact_engines()) {
      wrong_.look_at(measure("exact", engine, hall_, ""));
    }
    measure("float", float_, hall_, "");
  }

  void far_origins() {
    for (const auto& [name, shift] : {std::pair{"UTM", kUtm}, {"10,000 km", kFar}}) {
      const SceneFiles files = bench_.shifted("hall", hall_, shift);
      for (const EngineChoice& engine : {bench_.engine("kdtree cpu"), fast_, grid_}) {
        measure("exact, far origin", engine, files, name);
      }
      measure("float, far origin", float_, files, name);
    }
  }

  void tolerances() {
    for (const char* tolerance : {"1e-6", "1e-5", "1e-4", "1e-3", "0.01", "0.05"}) {
      measure("tolerance", fast_.with({kToleranceOption, tolerance}), hall_, tolerance);
    }
  }

  void thinned_models() {
    for (const double voxel : {0.005, 0.01, 0.02, 0.05}) {
      SceneFiles files = hall_;
      files.model = bench_.work() / "thinned-model.ply";
      write_thinned_model(hall_.model, files.model, voxel);
      measure("model thinned", fast_, files, voxel);
    }
  }

  void thinned_trajectories() {
    for (const std::uint64_t n : {2, 5, 10}) {
      SceneFiles files = hall_;
      files.trajectory = bench_.work() / "every-nth-pose.txt";
      write_every_nth_pose(hall_.trajectory, files.trajectory, n);
      measure("every nth pose", fast_, files, n);
    }
  }

  void coarser_environments() {
    for (const char* scale : {"1e-6", "1e-5", "1e-4", "1e-3", "1e-2"}) {
      SceneFiles files = hall_;
      files.store = bench_.store("hall-" + bench_.options().size + "-scale-" + scale,
                                 hall_.environment, {"--scale", scale});
      measure("environment quantised", fast_, files, scale);
    }
  }

  /// Throws Error where an exact engine decided points wrongly on the unchanged files.
  void finish() const { wrong_.refuse(); }

 private:
  Json measure(const std::string& method, const EngineChoice& engine, const SceneFiles& files,
               const Json& value) {
    const std::string key = method + "/" + engine.name + "/" + value.dump();
    return bench_.measure(
        key, {{"method", method}, {"engine", engine.name}, {"value", value}}, files, engine.options,
        [&](const std::filesystem::path& result) { return judged(result, truth_); }, {},
        engine.exact ? Refusal::kNone : Refusal::kMemory);
  }

  Bench& bench_;
  SceneFiles hall_;
  EngineChoice fast_, grid_, float_;
  std::filesystem::path truth_;
  WrongCases wrong_;
};

}  // namespace

void bench_accuracy(Bench& bench) {
  Accuracy accuracy(bench);
  accuracy.engines();
  accuracy.far_origins();
  accuracy.tolerances();
  accuracy.thinned_models();
  accuracy.thinned_trajectories();
  accuracy.coarser_environments();
  accuracy.finish();
}

}  // namespace clearway::bench
