#include "search/choice/field_fineness.hpp"

#include <algorithm>
#include <cmath>

#include "core/sweep/model_field.hpp"

namespace clearway {
namespace {

/// Of a field of the finest voxel: the share of reached points that need an exact test with one
/// pose, and how it grows with the poses.
constexpr double kExactShare = 0.004;
constexpr double kExactGrowth = 0.5;
/// Seconds of a node over those of an exact test.
constexpr double kNodeCost = 2.25;
/// With the voxel, nodes fall by its power 2, and exact tests grow by 2.5.
constexpr double kPower = 4.5;
/// Both curves are flat. Finer is the smaller risk.
constexpr double kCaution = 0.85;
constexpr double kCoarsest = 4;

/// Nodes of the bricks around a surface of `square_metres`.
double nodes_of(double square_metres, double radius, double voxel) {
  const double side = ModelFieldRef::kBrick * voxel;
  const double thick = 2 * (radius + 2 * voxel) + side;
  return ModelFieldRef::kBrickNodes * std::max(1.0, square_metres * thick / (side * side * side));
}

}  // namespace

double field_fineness(const Workload& work, double spacing) {
  const double voxel = ModelField::usual_voxel(spacing, work.radius);
  const double nodes = nodes_of(work.model_points * spacing * spacing, work.radius, voxel);
  const double exact = kExactShare * work.reached_points * std::pow(work.poses, kExactGrowth);
  const double coarser = kCaution * std::pow(kNodeCost * nodes / (exact + 1), 1 / kPower);
  return 1 / std::clamp(coarser, 1.0, kCoarsest);
}

}  // namespace clearway
