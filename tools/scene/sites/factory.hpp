#pragma once

#include "scene/sites/kinds.hpp"
#include "scene/vehicles/models.hpp"

/// What the hall and the plant share: a production line with a conveyor, seen by a scanner that
/// rides on it (the paper, section 4.3), and a car body that follows.
namespace clearway::scene {

struct FactoryDesign {
  std::vector<PathPiece> line;  ///< of the conveyor
  double half_width;            ///< of the aisle between the walls; less than any bend's radius
  double height;                ///< of the ceiling
  CarBodySize car;
  double rail_width;       ///< of the conveyor's two rails
  double fixture_spacing;  ///< between fixtures that reach close to the body, along the line
  double guide_gap;        ///< at most, between guide rails of one side
  double density_aspect;   ///< of rays_a_sweep
};

std::unique_ptr<const Scene> make_factory(Kind kind, const FactoryDesign& design,
                                          const Sizes& sizes, std::uint64_t seed);

/// Adds racks, machines, columns, robots, people, cables, lights and beams, floor to ceiling.
void furnish(World& world, const FactoryDesign& design, double length, std::uint64_t seed);

}  // namespace clearway::scene
