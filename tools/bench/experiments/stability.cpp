// Where methods fail: as the origin moves away, the scene grows sparse, the radius goes to its
// extremes, memory shrinks, poses get noisy or are not rigid.
#include <algorithm>
#include <optional>

#include "bench/experiments/bench.hpp"
#include "bench/measure/scoring.hpp"
#include "bench/variants/boundary_scene.hpp"
#include "bench/variants/variants.hpp"
#include "clearway/error.hpp"

namespace clearway::bench {
namespace {

/// The paper's grid: cells along the longest side of the environment's box.
constexpr double kRegularCells = 50;

/// Points of a chunk of the regular layouts, to which every cell is padded. They are few because a
/// cell of 2 m holds some 40 points at size small: there 4096 make the store 13 times as large and
/// its conversion take twice as long; 64 make it half as large, and no faster.
constexpr int kSmallChunk = 256;

class Stability {
 public:
  explicit Stability(Bench& bench)
      : bench_(bench),
        hall_(bench.scene("hall")),
        fast_(bench.engine_here("sweep")),
        grid_(bench.engine_here("grid")),
        float_(bench.engine_here("grid float")),
        kdtree_(bench.engine("kdtree cpu")),
        truth_(bench.truth("hall", hall_)) {}

  void boundary() {
    bench_.keep("near the boundary", {{"vary", "boundary"}}, [&] { return near_boundary(truth_); });
    const auto las = bench_.work() / "boundary.las";
    const SceneFiles files{.environment = las,
                           .store = bench_.work() / "boundary.h5",
                           .model = bench_.work() / "boundary.ply",
                           .trajectory = bench_.work() / "boundary.txt"};
    write_boundary_scene(las, files.model, files.trajectory, std::stod(kRadius));
    bench_.store("boundary", las);
    for (const EngineChoice& engine : {kdtree_, fast_, grid_, float_}) {
      const Json found =
          measure("ulps", std::stod(kRadius), engine, files, {}, decided_at_boundary, 1);
      if (engine.exact) wrong_.look_at(found);
    }
  }

  void origin() {
    for (const double far : {0.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7}) {
      const SceneFiles files = far == 0 ? hall_ : bench_.shifted("hall", hall_, {far, far, 0});
      for (const EngineChoice& engine : {kdtree_, fast_, grid_, float_}) {
        const Json found = measure("origin", far, engine, files, {}, judge(), 1);
        if (far == 0 && engine.exact) wrong_.look_at(found);
      }
    }
  }

  void sparseness() {
    const SceneFiles tunnel = bench_.scene("tunnel");
    for (const double factor : {1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0}) {
      SceneFiles files = tunnel;
      files.environment = bench_.work() / "stretched.las";
      stretch_environment(tunnel.environment, files.environment, factor);
      const double side = factor * kTunnelLength / kRegularCells;
      layout(files, factor, "adaptive", {});
      layout(files, factor, "regular, 50 cells along", side);
      layout(files, factor, "regular, 2 m", 2.0);
    }
  }

  void radius() {
    for (const double radius : {0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0}) {
      for (const EngineChoice& engine : {kdtree_, fast_, grid_}) {
        measure("radius", radius, engine, hall_, {"--radius", std::to_string(radius)}, {}, 1);
      }
    }
  }

  void memory(const std::string& option, Remedy remedy, const EngineChoice& engine) {
    const Json refused = measure("least" + option, 1, engine, hall_, {option, "1"}, {}, 1);
    const std::string log = refused.value("failed", Json::object()).value("log", "");
    const std::optional<std::uint64_t> least = amount_in(log, remedy);
    if (!least) throw Error("a refusal does not say the least " + option + ": " + log);
    for (const double share : {0.99, 1.0, 1.05, 1.2, 1.5, 2.0, 4.0, 8.0}) {
      const auto bytes = static_cast<std::uint64_t>(share * static_cast<double>(*least));
      wrong_.look_at(
          measure(option, bytes, engine, hall_, {option, std::to_string(bytes)}, judge()));
    }
  }

  void noise() {
    for (const double sigma : {0.0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1}) {
      SceneFiles files = hall_;
      files.trajectory = bench_.work() / "noisy.txt";
      write_noisy_poses(hall_.trajectory, files.trajectory, sigma, sigma, 1);
      against_kdtree("noise of the poses", sigma, files, {});
    }
    for (const double stretch : {0.0, 1e-6, 1e-5, 9e-5, 1e-3, 1e-2, 0.1}) {
      SceneFiles files = hall_;
      files.trajectory = bench_.work() / "stretched.txt";
      write_non_rigid_poses(hall_.trajectory, files.trajectory, stretch);
      against_kdtree("stretch of the poses", stretch, files, {"--allow-non-rigid"});
      measure("stretch without --allow-non-rigid", stretch, fast_, files, {}, {}, 1,
              Refusal::kNonRigidPoses);
    }
  }

  /// Throws Error where an exact engine decided points wrongly on the unchanged files, or otherwise
  /// than another one.
  void finish() const { wrong_.refuse(); }

 private:
  static constexpr double kTunnelLength = 1335;  // metres, in the paper's size

  Bench::Judge judge() const {
    return [this](const std::filesystem::path& result) { return judged(result, truth_); };
  }

  Json measure(const std::string& vary, const Json& value, const EngineChoice& engine,
               const SceneFiles& files, const std::vector<std::string>& more,
               const Bench::Judge& judge, std::optional<int> repetitions = {},
               Refusal expected = Refusal::kMemory) {
    return bench_.measure(vary + "/" + engine.name + "/" + value.dump(),
                          {{"vary", vary}, {"value", value}, {"engine", engine.name}}, files,
                          engine.with(more).options, judge, repetitions, expected);
  }

  /// Whether a conversion and the runs on its store are known.
  bool has_layout(const std::string& key) const {
    const Json* conversion = bench_.find(key);
    if (!conversion) return false;
    if ((*conversion)["findings"].contains("failed")) return true;
    return bench_.find(key + "/" + fast_.name) && bench_.find(key + "/" + grid_.name);
  }

  /// Converts and runs; the conversion's figures are a case of their own. side: the side of a
  /// regular layout's cells, metres.
  void layout(SceneFiles files, double factor, const std::string& name,
              std::optional<double> side) {
    const Json value = factor;
    Json parameters{{"vary", "sparseness"}, {"value", factor}, {"layout", name}};
    std::vector<std::string> options;
    if (side) {
      parameters["chunk_points"] = kSmallChunk;
      options = {"--layout", "regular:" + std::to_string(*side), "--cell-points",
                 std::to_string(kSmallChunk)};
    }
    const std::string key = "sparseness/" + name + "/" + value.dump();
    files.store = bench_.work() / "sparse.h5";
    if (has_layout(key)) return;
    const Json converted = bench_.convert(key, files.environment, files.store, options);
    for (const EngineChoice& engine : {fast_, grid_}) {
      Json of_run = parameters;
      of_run["engine"] = engine.name;
      if (converted.contains("failed")) continue;
      bench_.measure(key + "/" + engine.name, of_run, files, engine.options, {}, 1,
                     Refusal::kMemory);
    }
    bench_.keep(key, parameters, [&] { return Json(converted); });
  }

  /// Compares the other engines with the k-d tree; where that has no answer they are not asked.
  void against_kdtree(const std::string& vary, double value, const SceneFiles& files,
                      const std::vector<std::string>& more) {
    const Json tree = measure(vary, value, kdtree_, files, more, {}, 1);
    if (tree.contains("failed")) return;
    const std::string name = "kdtree " + vary + " " + Json(value).dump();
    const auto reference = bench_.answer(name, files, kdtree_.with(more).options);
    for (const EngineChoice& engine : {fast_, grid_}) {
      wrong_.look_at(measure(
          vary, value, engine, files, more,
          [&](const std::filesystem::path& result) { return compared(result, reference); }, 1));
    }
  }

  Bench& bench_;
  SceneFiles hall_;
  EngineChoice fast_, grid_, float_, kdtree_;
  std::filesystem::path truth_;
  WrongCases wrong_;
};

}  // namespace

void bench_stability(Bench& bench) {
  Stability stability(bench);
  stability.boundary();
  stability.origin();
  stability.sparseness();
  stability.radius();
  stability.memory("--memory", Remedy::kMoreMemory, bench.engine("sweep cpu"));
  if (bench.cuda()) {
    stability.memory("--device-memory", Remedy::kMoreDeviceMemory, bench.engine("sweep cuda"));
    stability.memory("--device-memory", Remedy::kMoreDeviceMemory, bench.engine("grid cuda"));
  }
  stability.noise();
  stability.finish();
}

}  // namespace clearway::bench
