#include "scene/scene.hpp"

#include "clearway/error.hpp"
#include "scene/sites/kinds.hpp"

namespace clearway::scene {

std::string_view name_of(Kind kind) {
  constexpr std::string_view kNames[] = {"hall", "plant", "mine", "tunnel"};
  return kNames[static_cast<int>(kind)];
}

Kind kind_named(std::string_view name) {
  for (const Kind kind : kAllKinds) {
    if (name_of(kind) == name) return kind;
  }
  throw UsageError("no such scene: " + std::string(name));
}

Sizes full_sizes(Kind kind) {
  constexpr Sizes kSizes[] = {{55872714, 214489, 17234},
                              {350109065, 434700, 398999},
                              {806183400, 100000, 17795},
                              {18919000, 28622, 19392}};
  return kSizes[static_cast<int>(kind)];
}

std::unique_ptr<const Scene> make_scene(Kind kind, const Sizes& sizes, std::uint64_t seed) {
  if (sizes.points == 0 || sizes.model_points == 0 || sizes.poses == 0) {
    throw UsageError("a scene needs at least one environment point, model point and pose");
  }
  switch (kind) {
    case Kind::kHall:
      return make_hall(sizes, seed);
    case Kind::kPlant:
      return make_plant(sizes, seed);
    case Kind::kMine:
      return make_mine(sizes, seed);
    case Kind::kTunnel:
      return make_tunnel(sizes, seed);
  }
  throw UsageError("no such kind of scene");
}

}  // namespace clearway::scene
