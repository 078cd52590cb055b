#include <algorithm>
#include <cmath>

#include "scene/sites/kinds.hpp"

/// Like the Train Tunnel: a curved tunnel between two open stretches, seen from two crossed scan
/// planes on the back of a train, and a wagon whose bogies follow the track (the paper,
/// section 4.3).
namespace clearway::scene {
namespace {

constexpr double kOpenBefore = 160, kTunnel = 1150;
constexpr double kOpenShare = 0.06;  // share of the sweeps on each open stretch
constexpr double kScannerHeight = 3.6;
constexpr double kOpenReach = 45;
constexpr double kGround = -0.75;  // ground beside the ballast bed; the rails' tops are at 0
constexpr double kHeapedShare = 0.8;
constexpr double kHalfGauge = 0.75;
constexpr Roughness kMasonry{0.03, 1.5, 0.015, 0.2};
constexpr Roughness kBallast{0.03, 0.25, 0.03, 0.06};
constexpr Roughness kTerrain{0.4, 6, 0.06, 0.3};

Path track() {
  constexpr double kBend = 1 / 320.0;
  const std::vector<PathPiece> pieces{
      {180, 0}, {60, kBend},      {320, kBend},     {60, 0}, {80, -kBend}, {280, -kBend},
      {60, 0},  {150, kBend / 2}, {120, kBend / 2}, {60, 0}, {130, 0}};
  return Path::from_pieces(pieces, 0.008);
}

Room tunnel_room() {
  constexpr double kHalf = 2.75, kSpring = 3.2;
  Room room{.begin_s = kOpenBefore, .walls = {{0, -1, 0.22, kBallast}}};
  constexpr int kSides = 16;
  for (int i = 0; i <= kSides; ++i) {
    const SineCosine angle = sine_cosine(kPi * i / kSides);
    room.walls.push_back({angle.cosine, angle.sine, kHalf + angle.sine * kSpring, kMasonry});
  }
  return room;
}

Room open_room(double begin) {
  return {.begin_s = begin, .walls = {{0, -1, -kGround, kTerrain}}, .open = true};
}

/// Adds rails with head and foot, sleepers, and ballast up to a little below their tops.
void add_track(World& world, double length, Dice& dice) {
  for (const double v : {-kHalfGauge, kHalfGauge}) {
    world.add_everywhere(v - 0.036, v + 0.036, -0.045, 0);
    world.add_everywhere(v - 0.01, v + 0.01, -0.15, -0.045);
    world.add_everywhere(v - 0.07, v + 0.07, -0.17, -0.15);
  }
  world.add_everywhere(-1.7, 1.7, kGround - 1, -0.2, kBallast);
  for (double s = -40; s < length + 40; s += 4) {  // ballast heaped between the rails
    if (dice.chance(kHeapedShare)) {
      world.add(box(s, 0, 2, 0.62, -0.3, 0.03, kBallast));
    }
  }
  for (double s = -40; s < length + 40; s += 0.6) {
    world.add(box(s, 0, 0.12, 1.3, -0.3, -0.17));
  }
}

void add_tunnel_fittings(World& world, Dice& dice) {
  const double end = kOpenBefore + kTunnel;
  for (double s = kOpenBefore; s < end; s += 2) {
    world.add(box(s + 1, 2.3, 1, 0.7, -0.5, 0.42));    // walkway
    world.add(box(s + 1, -2.35, 1, 0.4, -0.5, 0.05));  // cable duct
    world.add(box(s + 1, 2.68, 1, 0.04, 1.3, 1.36));   // handrail
    world.add(box(s + 1, -2.66, 1, 0.05, 1.9, 2.05));  // cables
    world.add(box(s + 1, 0, 1, 0.008, 5.2, 5.22));     // contact wire
  }
  for (double s = kOpenBefore + 12; s < end; s += 25) {
    world.add(box(s, 0.6, 0.05, 0.6, 5.35, 5.43));  // its cantilevers
    world.add(box(s, 1.2, 0.06, 0.06, 5.2, 6));
    world.add(box(s + 5, -2.6, 0.2, 0.15, 1.2, 1.8));  // boxes on the wall
  }
  for (double s = kOpenBefore + 5; s < end; s += dice.between(15, 45)) {  // left behind
    const double half_length = dice.between(0.2, 0.8);
    world.add(box(s, -1.75, half_length, 0.25, -0.2, dice.between(0.3, 0.7)));
  }
  for (double s = kOpenBefore + 30; s < end - 40; s += dice.between(40, 90)) {  // platforms
    const double side = random_side(dice);
    world.add(box(s, side * 2.2, 14, 0.7, -0.5, 0.9));
  }
  for (const double s : {kOpenBefore, end}) {  // portals
    for (const double v : {-7.3, 7.3}) world.add(box(s, v, 0.4, 4.5, -2, 8));
    world.add(box(s, 0, 0.4, 2.8, 6.0, 8));
  }
}

void add_open_fittings(World& world, double begin, double end, Dice& dice) {
  for (double s = begin + 10; s < end; s += 45) {
    world.add(box(s, 3.2, 0.15, 0.15, -2, 7));
    world.add(box(s, 1.6, 0.05, 1.6, 5.6, 5.7));
  }
  for (double s = begin; s < end; s += dice.between(1, 5)) {  // bushes and trees
    const double side = random_side(dice), radius = dice.between(0.3, 1.6);
    const double v = side * dice.between(6, 24);
    world.add(pole(s, v, radius, -2, dice.between(0.3, 6), {0.3 * radius, 0.5, 0.1, 0.15}));
  }
}

/// Where the train is at a share of the time. It runs faster outside the tunnel, so that the open
/// stretches get few sweeps.
double train_position(double share, double length) {
  if (share < kOpenShare) return share / kOpenShare * kOpenBefore;
  if (share > 1 - kOpenShare) {
    return kOpenBefore + kTunnel +
           (share - (1 - kOpenShare)) / kOpenShare * (length - kOpenBefore - kTunnel);
  }
  return kOpenBefore + (share - kOpenShare) / (1 - 2 * kOpenShare) * kTunnel;
}

/// A pose of the wagon with both pivots on the track's centreline, so that in a curve the middle
/// swings inwards and the ends outwards.
Pose wagon_pose(const Path& path, std::uint64_t number, std::uint64_t count) {
  constexpr double kEnds = 14;
  const double front_s =
      along(kEnds + kBogieDistance / 2, path.length() - kEnds + kBogieDistance / 2, number, count);
  const Vec3 front = path.to_world({front_s, 0, 0});
  double rear_s = front_s - kBogieDistance;
  for (int i = 0; i < 4; ++i) {  // the chord is a little shorter than the arc
    rear_s -= kBogieDistance - length(front - path.to_world({rear_s, 0, 0}));
  }
  const Vec3 rear = path.to_world({rear_s, 0, 0});
  return pose_along(0.5 * (front + rear), front - rear, {});
}

/// The density of points on a wagon that is scanned by hand: densest at the height of the chest,
/// thin at the roof.
double scanned_density(const Vec3& p) {
  return p.z < 2.2 ? 1 : std::max(0.35, 1 - 0.5 * (p.z - 2.2));
}

}  // namespace

std::unique_ptr<const Scene> make_tunnel(const Sizes& sizes, std::uint64_t seed) {
  auto scene = empty_scene(Kind::kTunnel, sizes, track(),
                           {open_room(-1e9), tunnel_room(), open_room(kOpenBefore + kTunnel)});
  const double length = scene->path.length();
  Dice dice(seed, kLayoutStream);
  add_track(scene->world, length, dice);
  add_tunnel_fittings(scene->world, dice);
  add_open_fittings(scene->world, -40, kOpenBefore, dice);
  add_open_fittings(scene->world, kOpenBefore + kTunnel, length + 40, dice);
  scene->plan = crossed_planes(sizes.points, kScannerHeight, kOpenReach,
                               [length](double share) { return train_position(share, length); });
  return with_vehicle(std::move(scene), seed, train_wagon(), 0.004, wagon_pose, scanned_density);
}

}  // namespace clearway::scene
