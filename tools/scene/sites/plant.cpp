#include "scene/sites/factory.hpp"

namespace clearway::scene {

std::unique_ptr<const Scene> make_plant(const Sizes& sizes, std::uint64_t seed) {
  constexpr double kBend = 1 / 16.0, kEase = 6;
  constexpr double kTurn = 3.14159265358979 / kBend - kEase;  // half a circle with its easements
  FactoryDesign design{.line = {{110, 0}},
                       .half_width = 13,
                       .height = 8,
                       .car = {4.9, 2.0, 1.75},
                       .rail_width = 0.28,
                       .fixture_spacing = 1.1,
                       .guide_gap = 6,
                       .density_aspect = 0.15};
  for (int line = 1; line < 5; ++line) {  // lines side by side, joined by turns
    const double bend = line % 2 == 1 ? kBend : -kBend;
    design.line.insert(design.line.end(), {{kEase, bend}, {kTurn, bend}, {kEase, 0}, {110, 0}});
  }
  return make_factory(Kind::kPlant, design, sizes, seed);
}

}  // namespace clearway::scene
