#pragma once

#include "core/cloud/packed_cloud.hpp"

namespace clearway {

/// Typical number of environment points per square metre of scanned surface, from the boxes of
/// blocks; 0 for an empty cloud.
double surface_density(const PackedCloud& cloud);

/// The grid cell size, metres, that makes a range search cheapest by a model of its cost: grid
/// cells looked up, (2 r / S + 1)^3, and points tested, density (2 r + S)^2 (docs/design/grid.md).
double cheapest_grid_cell(double radius, double density);

}  // namespace clearway
