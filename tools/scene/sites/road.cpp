#include <cmath>

#include "scene/sites/kinds.hpp"

/// A road through a village, scanned from a car with two crossed scan planes, and a lorry with a
/// high load. The lorry passes everywhere except at two places: a sign hangs too low over the lane,
/// and a van is parked where the front of the lorry swings out in a bend.
namespace clearway::scene {
namespace {

constexpr double kScannerHeight = 2.6;
constexpr double kReach = 40;
constexpr double kKerb = 3.2;  // half the width of the carriageway
constexpr double kPavement = 0.12;
constexpr double kOverhang = 6;           // from the middle of the lorry to its ends
constexpr double kSign = 70, kVan = 214;  // where the two obstacles are along the road
constexpr Roughness kAsphalt{0.01, 3, 0.004, 0.1};
constexpr Roughness kPlaster{0.01, 1, 0.005, 0.1};
constexpr Roughness kLeaves{0.3, 0.6, 0.12, 0.15};

Path road() {
  constexpr double kBend = 1 / 60.0, kNarrowBend = -1 / 40.0;
  const std::vector<PathPiece> pieces{{60, 0},           {25, kBend}, {45, kBend},
                                      {25, 0},           {35, 0},     {20, kNarrowBend},
                                      {40, kNarrowBend}, {20, 0},     {70, 0}};
  return Path::from_pieces(pieces, 0.01);
}

void add_houses(World& world, double length, Dice& dice) {
  for (const double side : {-1.0, 1.0}) {
    for (double s = -kReach; s < length + kReach;) {
      const double half_length = dice.between(4, 8), front = dice.between(6.5, 9);
      world.add(box(s + half_length, side * (front + 4), half_length, 4, -1, dice.between(5, 9),
                    kPlaster));
      s += 2 * half_length + dice.between(1, 9);
    }
  }
}

/// Adds lamp posts, trees whose crowns begin above the lorry, hedges and cars that are parked half
/// on the pavement.
void add_roadside(World& world, double length, Dice& dice) {
  for (double s = -20; s < length + 20; s += 28) {
    world.add(pole(s, 3.9, 0.08, 0, 6.2));
    world.add(box(s, 3, 0.06, 0.9, 6.1, 6.2));
  }
  for (double s = -10; s < length + 10; s += dice.between(9, 22)) {
    const double v = -dice.between(4.6, 5.2);
    world.add(pole(s, v, 0.2, 0, 5, {0.03, 0.2, 0.01, 0.05}));
    world.add(pole(s, v, 1.8, 4.9, dice.between(7, 10), kLeaves));
  }
  for (double s = 5; s < length; s += dice.between(7, 30)) {
    if (std::abs(s - kVan) < 12) continue;
    const double side = dice.chance(0.6) ? 1 : -1;
    world.add(box(s, side * 3.5, 2.1, 0.85, 0.2, dice.between(1.35, 1.6)));
  }
}

void add_obstacles(World& world) {
  world.add(pole(kSign, 3.6, 0.06, 0, 4.6));
  world.add(box(kSign, 2.4, 0.04, 1.2, 4.5, 4.6));
  world.add(box(kSign, 1.7, 0.05, 0.5, 3.6, 4.5));
  world.add(box(kVan, 2.6, 2.6, 0.95, 0.3, 2.4));
}

Pose lorry_pose(const Path& path, std::uint64_t number, std::uint64_t count) {
  const double s = along(kOverhang, path.length() - kOverhang, number, count);
  return pose_along(path.to_world({s, 0, 0}), path.direction(s), {});
}

}  // namespace

std::unique_ptr<const Scene> make_road(const Sizes& sizes, std::uint64_t seed) {
  auto scene = empty_scene(Kind::kRoad, sizes, road(),
                           {{.begin_s = -1e9, .walls = {{0, -1, 0, kAsphalt}}, .open = true}});
  const double length = scene->path.length();
  Dice dice(seed, kLayoutStream);
  for (const double side : {-1.0, 1.0}) {
    const double near = side * kKerb, far = side * 14;
    scene->world.add_everywhere(std::min(near, far), std::max(near, far), -0.5, kPavement,
                                kAsphalt);
  }
  add_houses(scene->world, length, dice);
  add_roadside(scene->world, length, dice);
  add_obstacles(scene->world);
  scene->plan = crossed_planes(sizes.points, kScannerHeight, kReach,
                               [length](double share) { return share * length; });
  return with_vehicle(std::move(scene), seed, lorry(), 0.002, lorry_pose);
}

}  // namespace clearway::scene
