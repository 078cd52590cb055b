// Cases that are hard for the sweep. The sweep and the k-d tree have to find the same points.
#include "bench/experiments/bench.hpp"
#include "bench/measure/scoring.hpp"
#include "bench/stages/set_engines.hpp"
#include "bench/variants/variants.hpp"

namespace clearway::bench {
namespace {

constexpr std::uint64_t kTurns = 10'000;
constexpr int kPasses = 20;
constexpr double kPassNoise = 0.005;  // metres; noise of the passes
constexpr std::uint64_t kPassSeed = 1;

class Hard {
 public:
  explicit Hard(Bench& bench)
      : bench_(bench),
        size_(bench.options().size == "small" ? "hard" : bench.options().size),
        hall_(bench.scene("hall", size_)) {}

  void paths() {
    compare("as it is", hall_);
    SceneFiles files = hall_;
    files.trajectory = bench_.work() / "hard.txt";
    write_turning_poses(hall_.trajectory, files.trajectory, kTurns);
    compare("rotation on the spot", files);
    write_to_and_fro(hall_.trajectory, files.trajectory, kPasses, kPassNoise, kPassSeed);
    compare("twenty passes, to and fro", files);
  }

  void along_a_wall() {
    const SceneFiles tunnel = bench_.scene("tunnel", size_);
    SceneFiles files = tunnel;
    files.trajectory = bench_.work() / "hard.txt";
    for (const double metres : {0.5, 1.0, 1.5}) {
      write_poses_aside(tunnel.trajectory, files.trajectory, metres);
      compare("tunnel, wagon shifted to the wall by " + Json(metres).dump(), files);
    }
  }

  void small_radii() {
    for (const std::string radius : {"0.001", "0.01"}) {
      compare("radius " + radius + ", voxel 0.05", hall_, {"--radius", radius},
              {kFieldVoxelOption, "0.05"});
      compare("radius " + radius + ", voxel chosen", hall_, {"--radius", radius});
    }
  }

  void sizes() {
    const scene::Sizes size = scene_size("hall", size_);
    for (const std::uint64_t n : {100, 1'000, 10'000, 100'000, 1'000'000}) {
      if (n <= most_) {
        compare("poses " + std::to_string(n), bench_.resized("hall", hall_, size.model_points, n));
      }
    }
    for (const std::uint64_t n : {1'000, 10'000, 100'000, 1'000'000}) {
      if (n <= most_) {
        compare("model points " + std::to_string(n), bench_.resized("hall", hall_, n, size.poses));
      }
    }
  }

  /// Throws ResultsDiffer where the engines' results are not the same bytes.
  void finish() const { wrong_.refuse(); }

 private:
  /// Runs both engines and compares their results. `of_sweep`: options for the sweep alone.
  void compare(const std::string& name, const SceneFiles& files,
               const std::vector<std::string>& options = {},
               const std::vector<std::string>& of_sweep = {}) {
    const EngineChoice sweep = bench_.engine_here("sweep").with(options).with(of_sweep);
    const EngineChoice kdtree = bench_.engine("kdtree cpu").with(options);
    bench_.measure(name + "/" + sweep.name, {{"case", name}, {"engine", sweep.name}}, files,
                   sweep.options);
    wrong_.look_at(bench_.measure(name + "/" + kdtree.name,
                                  {{"case", name}, {"engine", kdtree.name}}, files, kdtree.options,
                                  [&](const std::filesystem::path& result) -> Json {
                                    const auto reference = bench_.work() / "reference.h5";
                                    bench_.run(files, reference, sweep.options);
                                    return compared(result, reference);
                                  }));
  }

  Bench& bench_;
  std::string size_;
  SceneFiles hall_;
  std::uint64_t most_ = bench_.options().size == "smoke" ? 1'000 : 1'000'000;
  WrongCases wrong_;
};

}  // namespace

void bench_hard(Bench& bench) {
  Hard hard(bench);
  hard.paths();
  hard.along_a_wall();
  hard.small_radii();
  hard.sizes();
  hard.finish();
}

}  // namespace clearway::bench
