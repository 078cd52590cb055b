// Compares a surface with points sampled on it ever more closely: time, and which points the
// samples miss. The truth is the surface's exact distances.
#include <cmath>

#include "bench/experiments/bench.hpp"
#include "bench/measure/scoring.hpp"
#include "bench/variants/variants.hpp"
#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "io/files/input_error.hpp"

namespace clearway::bench {
namespace {

constexpr double kSurfaceRadius = 0.1;  ///< the radius kRadius as a number
/// The radius is divided by each of these to give a spacing. The third gives ten points a triangle
/// on the hall's body.
constexpr int kParts[] = {4, 8, 12, 16, 64};
constexpr std::uint64_t kTriangles = 20'000, kTrianglesOfSmoke = 2'000;

bool smoke(const Bench& bench) { return bench.options().size == "smoke"; }

class Surfaces {
 public:
  Surfaces(Bench& bench, std::string name, SceneFiles files)
      : bench_(bench),
        name_(std::move(name)),
        files_(std::move(files)),
        sweep_(bench.engine_here("sweep")) {}

  void compare() {
    const EngineChoice surface = sweep_.with({"--model-as", "surface"});
    truth_ =
        bench_.answer("surface-" + name_, files_, surface.with({"--clearance", "0.3"}).options);
    wrong_.look_at(measure("surface", "", surface));
    for (const int parts : kParts) {
      if (smoke(bench_) && parts == 64) continue;
      const double spacing = kSurfaceRadius / parts;
      const Json sampled =
          measure("sampled", "r / " + std::to_string(parts),
                  sweep_.with({"--model-as", "points", "--model-spacing", format_number(spacing)}));
      check(sampled, spacing);
    }
    wrong_.refuse();
  }

 private:
  Json measure(const std::string& method, const std::string& value, const EngineChoice& engine) {
    return bench_.measure(
        name_ + "/" + method + (value.empty() ? "" : "/" + value),
        {{"scene", name_}, {"method", method}, {"engine", engine.name}, {"value", value}}, files_,
        engine.options,
        [&](const std::filesystem::path& result) { return judged(result, truth_); });
  }

  /// Throws where a distance to the samples contradicts the surface's: a sample lies on the
  /// surface, and no place of the surface is farther from a sample than the spacing. Both distances
  /// are rounded, and so are the samples.
  static void check(const Json& sampled, double spacing) {
    if (!sampled.contains("findings")) return;  // the run took too long
    const Json& found = sampled["findings"];
    constexpr double kRounding = 1e-9;
    const bool beyond = found["largest_distance"].get<double>() > spacing + kRounding;
    if (found["false_hits"] == 0 && !beyond) return;
    throw ResultsDiffer(sampled["key"].get<std::string>() +
                        ": expected points within the spacing of the surface's, found " +
                        found.dump());
  }

  Bench& bench_;
  std::string name_;
  SceneFiles files_;
  EngineChoice sweep_;
  std::filesystem::path truth_;
  WrongCases wrong_;
};

}  // namespace

void bench_surfaces(Bench& bench) {
  if (!bench.options().also.store.empty()) {
    Surfaces(bench, "given", bench.options().also).compare();
    return;
  }
  SceneFiles hall = bench.scene("hall");
  const std::filesystem::path body = bench.work() / "body.off";
  if (!std::filesystem::exists(body)) {
    write_body(hall.model, body, smoke(bench) ? kTrianglesOfSmoke : kTriangles);
  }
  hall.model = body;
  Surfaces(bench, "hall", hall).compare();
}

}  // namespace clearway::bench
