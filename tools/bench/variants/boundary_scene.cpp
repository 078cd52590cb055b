#include "bench/variants/boundary_scene.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>

#include "io/result/result.hpp"
#include "io/scans/las/las_writer.hpp"
#include "scene/random.hpp"

namespace clearway::bench {
namespace {

constexpr int kOctaves = 31;
constexpr int kPointsAnOctave = 64;  // for each sign

std::size_t octave_of(std::int32_t step) {
  return static_cast<std::size_t>(std::bit_width(static_cast<std::uint32_t>(std::abs(step)) | 1u)) -
         1;
}

}  // namespace

std::vector<std::int32_t> steps_beside_boundary() {
  std::vector<std::int32_t> steps{0};
  const scene::Random random(1, 0);
  for (int i = 0; i < kOctaves; ++i) {
    for (int j = 0; j < kPointsAnOctave; ++j) {
      const double step = std::ldexp(1 + random.unit(steps.size()), i);
      steps.push_back(static_cast<std::int32_t>(step));
      steps.push_back(-steps.back());
    }
  }
  return steps;
}

void write_boundary_scene(const std::filesystem::path& las, const std::filesystem::path& model,
                          const std::filesystem::path& trajectory, double radius) {
  const double ulp = std::nextafter(radius, std::numeric_limits<double>::infinity()) - radius;
  const std::vector<std::int32_t> steps = steps_beside_boundary();
  const auto [least, greatest] = std::minmax_element(steps.begin(), steps.end());
  const File file = File::create(las);
  LasWriter writer(file, {.quantisation = {{ulp, ulp, ulp}, {radius, 0, 0}},
                          .points = steps.size(),
                          .bounds = {{*least, 0, 0}, {*greatest, 0, 0}}});
  std::vector<std::array<std::int32_t, 3>> quanta;
  quanta.reserve(steps.size());
  for (const std::int32_t step : steps) quanta.push_back({step, 0, 0});
  writer.write(quanta);
  writer.finish();
  std::ofstream(model) << "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\n"
                          "property double y\nproperty double z\nend_header\n0 0 0\n";
  std::ofstream(trajectory) << "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n";
}

Json decided_at_boundary(const std::filesystem::path& result) {
  const std::vector<std::int32_t> steps = steps_beside_boundary();
  std::vector<bool> found(steps.size());
  const ResultReader reader(result);
  for (CollisionCursor rows(reader); !rows.at_end(); rows.advance()) found.at(rows.source()) = true;
  std::vector<int> points(kOctaves), wrong(kOctaves);
  int false_hits = 0, misses = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const bool collides = steps[i] < 0;
    ++points[octave_of(steps[i])];
    wrong[octave_of(steps[i])] += found[i] != collides;
    false_hits += found[i] && !collides;
    misses += collides && !found[i];
  }
  return {{"false_hits", false_hits}, {"misses", misses}, {"points", points}, {"wrong", wrong}};
}

}  // namespace clearway::bench
