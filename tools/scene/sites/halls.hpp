#pragma once

#include "scene/sites/kinds.hpp"
#include "scene/vehicles/vehicles.hpp"

/// What the hall and the plant share: a production line with a conveyor, seen by a scanner that
/// rides on it (the paper, section 4.3), and a car body that follows.
namespace clearway::scene {

struct FactoryDesign {
  std::vector<PathPiece> line;  ///< the path of the conveyor
  double half_width;            ///< half the width of the aisle; less than any bend's radius
  double height;                ///< height of the ceiling
  CarBodySize car;
  double rail_width;       ///< width of each of the conveyor's two rails
  double fixture_spacing;  ///< along the line, between fixtures that reach close to the body
  double guide_gap;        ///< greatest gap between guide rails on one side
  double density_aspect;   ///< the aspect of rays_a_sweep
};

std::unique_ptr<const Scene> make_factory(Kind kind, const FactoryDesign& design,
                                          const Sizes& sizes, std::uint64_t seed);

/// Adds racks, machines, columns, robots, people, cables, lights and beams, floor to ceiling.
void furnish(World& world, const FactoryDesign& design, double length, std::uint64_t seed);

}  // namespace clearway::scene
