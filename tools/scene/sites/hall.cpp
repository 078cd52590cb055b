#include "scene/sites/factory.hpp"

namespace clearway::scene {

std::unique_ptr<const Scene> make_hall(const Sizes& sizes, std::uint64_t seed) {
  constexpr double kBend = 1 / 16.0;
  const FactoryDesign design{.line = {{24, 0},
                                      {4, kBend},
                                      {10, kBend},
                                      {4, 0},
                                      {8, 0},
                                      {4, -kBend},
                                      {10, -kBend},
                                      {4, 0},
                                      {20, 0}},
                             .half_width = 12,
                             .height = 7,
                             .car = {4.5, 1.9, 1.5},
                             .rail_width = 0.14,
                             .fixture_spacing = 1.6,
                             .guide_gap = 8,
                             .density_aspect = 0.4};
  return make_factory(Kind::kHall, design, sizes, seed);
}

}  // namespace clearway::scene
