#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "bench/measure/publish.hpp"
#include "bench/variants/variants.hpp"
#include "clearway/error.hpp"
#include "clearway/model.hpp"
#include "core/geometry/predicate.hpp"
#include "core/util/format.hpp"
#include "io/scans/ply/ply_writer.hpp"

namespace clearway::bench {
namespace {

struct Candidate {
  std::size_t point;
  double squared_distance;  ///< to the voxel's centre
};

/// For every point, whether it is kept as the one of its voxel.
std::vector<bool> one_a_voxel(const std::vector<Vec3>& points, double voxel) {
  std::map<std::array<double, 3>, Candidate> nearest;
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::array<double, 3> cell{};
    Vec3 centre{};
    for (int k = 0; k < 3; ++k) {
      cell[k] = std::floor(points[i][k] / voxel);
      centre[k] = (cell[k] + 0.5) * voxel;
    }
    const Candidate candidate{i, squared_distance(points[i], centre)};
    const auto [found, first] = nearest.try_emplace(cell, candidate);
    if (!first && candidate.squared_distance < found->second.squared_distance) {
      found->second = candidate;
    }
  }
  std::vector<bool> kept(points.size());
  for (const auto& [cell, candidate] : nearest) kept[candidate.point] = true;
  return kept;
}

}  // namespace

void write_thinned_model(const std::filesystem::path& in, const std::filesystem::path& out,
                         double voxel) {
  if (!(voxel > 0 && std::isfinite(voxel))) {
    throw UsageError("a voxel of " + format_number(voxel) + " m; expected a positive length");
  }
  const std::vector<Vec3> points = read_model_points(in);
  const std::vector<bool> kept = one_a_voxel(points, voxel);
  std::vector<Vec3> thinned;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (kept[i]) thinned.push_back(points[i]);
  }
  publish(in, out, [&](const File& file) {
    PlyWriter writer(file, {.points = thinned.size()});
    writer.write(thinned);
    writer.finish();
  });
}

}  // namespace clearway::bench
