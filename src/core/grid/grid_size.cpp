#include "core/grid/grid_size.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace clearway {
namespace {

/// Number of blocks that are looked at for the density.
constexpr std::size_t kSamples = 4096;

/// Cost of looking up a grid cell, in tests of a point.
constexpr double kLookUpCost = 3;

}  // namespace

double surface_density(const PackedCloud& cloud) {
  std::vector<double> densities;
  const std::size_t blocks = cloud.cells().size() * cloud.blocks_per_cell();
  const std::size_t step = std::max<std::size_t>(1, blocks / kSamples);
  for (std::size_t i = 0; i < blocks; i += step) {
    const auto cell = static_cast<std::uint32_t>(i / cloud.blocks_per_cell());
    const auto block = static_cast<std::uint32_t>(i % cloud.blocks_per_cell());
    // Blocks that are not full are left out.
    if ((block + 1) * kBlockPoints > cloud.cells()[cell].count) continue;
    const Box box = cloud.block_box(cell, block);
    double sides[3] = {box.hi.x - box.lo.x, box.hi.y - box.lo.y, box.hi.z - box.lo.z};
    std::sort(sides, sides + 3);
    const double area = sides[1] * sides[2];
    if (area > 0) densities.push_back(kBlockPoints / area);
  }
  if (densities.empty()) return 0;
  const auto middle = densities.begin() + static_cast<std::ptrdiff_t>(densities.size() / 2);
  std::nth_element(densities.begin(), middle, densities.end());
  return *middle;
}

double cheapest_grid_cell(double radius, double density) {
  const double in_square = density * radius * radius;
  double best = 1, least = std::numeric_limits<double>::infinity();
  for (const double of_radius : {0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0}) {
    const double look_ups = std::pow(2 / of_radius + 1, 3);
    const double points = in_square * (2 + of_radius) * (2 + of_radius);
    const double cost = kLookUpCost * look_ups + points;
    if (cost < least) {
      least = cost;
      best = of_radius;
    }
  }
  return best * radius;
}

}  // namespace clearway
