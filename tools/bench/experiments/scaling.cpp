// Time by the number of poses, of model points, the radius, and the points of a cell.
#include "bench/experiments/bench.hpp"

namespace clearway::bench {
namespace {

class Scaling {
 public:
  explicit Scaling(Bench& bench) : bench_(bench), hall_(bench.scene("hall")) {}

  void poses() {
    for (const std::uint64_t n : {100, 300, 1'000, 3'000, 10'000, 30'000}) {
      if (!bench_.full() && n > 10'000) continue;
      measure("poses", n, bench_.resized("hall", hall_, size_.model_points, n), {});
    }
  }

  void model_points() {
    for (const std::uint64_t n : {1'000, 3'000, 10'000, 30'000, 100'000, 300'000, 1'000'000}) {
      if (!bench_.full() && n > 100'000) continue;
      measure("model points", n, bench_.resized("hall", hall_, n, size_.poses), {});
    }
  }

  void radius() {
    for (const double r : {0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0}) {
      measure("radius", r, hall_, {"--radius", std::to_string(r)});
    }
  }

  void cell_points() {
    for (const std::uint64_t n : {256, 1'024, 4'096, 16'384, 65'536, 262'144}) {
      SceneFiles files = hall_;
      files.store = bench_.store("hall-" + bench_.options().size + "-cells-" + std::to_string(n),
                                 hall_.environment, {"--cell-points", std::to_string(n)});
      measure("cell points", n, files, {});
    }
  }

 private:
  void measure(const std::string& vary, const Json& value, const SceneFiles& files,
               const std::vector<std::string>& more) {
    for (const EngineChoice& engine : bench_.exact_engines()) {
      bench_.measure(engine.name + "/" + vary + "/" + value.dump(),
                     {{"engine", engine.name}, {"vary", vary}, {"value", value}}, files,
                     engine.with(more).options, {}, {}, Refusal::kMemory);
    }
  }

  Bench& bench_;
  SceneFiles hall_;
  scene::Sizes size_ = scene_size("hall", bench_.options().size);
};

}  // namespace

void bench_scaling(Bench& bench) {
  Scaling scaling(bench);
  scaling.poses();
  scaling.model_points();
  scaling.radius();
  scaling.cell_points();
}

}  // namespace clearway::bench
