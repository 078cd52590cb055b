#include <cmath>

#include "scene/sites/kinds.hpp"

namespace clearway::scene {
namespace {

/// What the hall and the plant share: a production line with a conveyor, seen by a scanner that
/// rides on it (the paper, section 4.3), and a car body that follows.
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

/// Where a piece of furniture stands: `side` is 1 on the left and -1 on the right of the line.
struct Spot {
  double s, v;
  double side;
};

void add_rack(World& world, const Spot& spot, Dice& dice) {
  const double half = dice.between(0.8, 1.4), depth = 0.45;
  for (const double ds : {-half, half}) {
    for (const double dv : {-depth, depth}) {
      world.add(box(spot.s + ds, spot.v + dv, 0.04, 0.04, 0, 2.4));
    }
  }
  for (int shelf = 0; shelf < 4; ++shelf) {
    const double w = 0.3 + 0.65 * shelf;
    world.add(box(spot.s, spot.v, half, depth, w, w + 0.04));
    for (double s = -half + 0.3; s < half - 0.2; s += 0.55) {
      if (dice.chance(0.6)) {
        world.add(box(spot.s + s, spot.v, 0.2, 0.3, w + 0.04, w + dice.between(0.15, 0.45)));
      }
    }
  }
}

void add_machine(World& world, const Spot& spot, Dice& dice) {
  const double half_length = dice.between(0.5, 1.2), half_width = dice.between(0.4, 0.9);
  Prism base = box(spot.s, spot.v, half_length, half_width, 0, dice.between(0.9, 1.6));
  base.turn = sine_cosine(dice.between(-0.3, 0.3));
  world.add(base);
  Prism head = base;
  head.half_length *= 0.6;
  head.half_width *= 0.7;
  head.bottom = base.top;
  head.top = base.top + dice.between(0.3, 1.2);
  world.add(head);
  world.add(box(spot.s + base.half_length + 0.3, spot.v, 0.12, 0.2, 0.9, 1.5));
}

/// Adds a robot that stands beside the line and holds an arm towards it.
void add_robot(World& world, const Spot& spot, Dice& dice) {
  world.add(pole(spot.s, spot.v, 0.35, 0, 0.5));
  world.add(pole(spot.s, spot.v, 0.2, 0.5, dice.between(1.4, 2.0)));
  const double reach = dice.between(0.4, 0.9);
  Prism arm = box(spot.s, spot.v - spot.side * reach / 2, 0.1, reach / 2, 1.5, 1.75);
  arm.turn = sine_cosine(dice.between(-0.5, 0.5));
  world.add(arm);
}

void add_person(World& world, const Spot& spot, Dice& dice) {
  const double height = dice.between(1.6, 1.9);
  for (const double ds : {-0.1, 0.1}) world.add(pole(spot.s + ds, spot.v, 0.08, 0, 0.85));
  world.add(pole(spot.s, spot.v, 0.2, 0.85, height - 0.28));
  world.add(pole(spot.s, spot.v, 0.1, height - 0.28, height));
}

void add_trolley(World& world, const Spot& spot, Dice& dice) {
  Prism bed = box(spot.s, spot.v, 0.6, 0.35, 0.15, 0.3);
  bed.turn = sine_cosine(dice.between(-0.8, 0.8));
  world.add(bed);
  bed.half_length = 0.4;
  bed.half_width = 0.25;
  bed.bottom = 0.3;
  bed.top = dice.between(0.5, 1.1);
  world.add(bed);
}

void add_crate(World& world, const Spot& spot, Dice& dice) {
  const double half_length = dice.between(0.3, 0.6), half_width = dice.between(0.3, 0.6);
  world.add(box(spot.s, spot.v, half_length, half_width, 0, dice.between(0.5, 1.4)));
}

void add_clutter(World& world, const Spot& spot, Dice& dice) {
  constexpr void (*kKinds[])(World&, const Spot&, Dice&){add_rack,   add_machine, add_robot,
                                                         add_person, add_trolley, add_crate};
  kKinds[dice.choice(6)](world, spot, dice);
}

/// Adds rows of clutter on both sides, the first just clear of the body.
void add_rows(World& world, const FactoryDesign& design, double length, Dice& dice) {
  for (const double side : {-1.0, 1.0}) {
    for (double row = 2.3; row < design.half_width - 1; row += 2.6) {
      for (double s = -12; s < length + 12; s += dice.between(1.8, 3.8)) {
        add_clutter(world, {s, side * (row + dice.between(-0.2, 0.4)), side}, dice);
      }
    }
  }
}

/// Adds clamps, sensors and guides on posts beside the line; some touch the body, most just miss
/// it.
void add_fixtures(World& world, const FactoryDesign& design, double length, Dice& dice) {
  const double half = design.car.width / 2;
  for (double s = 0; s < length; s += design.fixture_spacing * dice.between(0.6, 1.4)) {
    const double side = random_side(dice);
    const double gap = dice.between(-0.06, 0.3), w = dice.between(0.6, 1.5);
    const double size = dice.between(0.08, 0.2);
    world.add(box(s, side * (half + gap + 0.2), size, 0.2, w, w + dice.between(0.1, 0.5)));
    world.add(box(s, side * (half + gap + 0.35), 0.06, 0.06, 0, w));
  }
}

/// Adds rails at the height of the bumpers that guide the body on some stretches, within its reach.
void add_guides(World& world, const FactoryDesign& design, double length, Dice& dice) {
  const double half = design.car.width / 2;
  for (const double side : {-1.0, 1.0}) {
    for (double s = 0; s < length; s += dice.between(4, 4 + design.guide_gap)) {
      const double stretch = dice.between(0.8, 1.8), w = dice.between(0.65, 0.9);
      const double v = side * (half + dice.between(0.03, 0.12));
      world.add(box(s, v, stretch, 0.03, w, w + 0.12));
      world.add(box(s, v + side * 0.1, 0.05, 0.05, 0, w + 0.05));
    }
  }
}

void add_overhead(World& world, const FactoryDesign& design, double length, Dice& dice) {
  const double top = design.height;
  for (double s = -12; s < length + 12; s += 4) {
    world.add(box(s, 0, 0.12, design.half_width, top - 0.6, top - 0.2));  // beam
    world.add(box(s + 2, 1.6, 0.6, 0.08, top - 1.6, top - 1.5));          // lights
    world.add(box(s + 2, -1.6, 0.6, 0.08, top - 1.6, top - 1.5));
    if (dice.chance(0.5)) {
      const double v = dice.between(-6, 6);
      world.add(box(s + 1, v, 0.02, 0.02, dice.between(2.6, 4), top));  // hanging hose
    }
  }
  for (double s = -8; s < length + 8; s += 8) {
    for (const double v : {-5.6, 5.6}) world.add(box(s, v, 0.2, 0.2, 0, top));  // columns
  }
  for (const double v : {-4.2, -1.9, 2.3, 4.6}) {  // cable trays and pipes
    const double w = dice.between(top - 2.6, top - 1.7);
    world.add_everywhere(v - 0.15, v + 0.15, w, w + 0.08);
    world.add_everywhere(v + 0.3, v + 0.36, w + 0.2, w + 0.26);
  }
}

/// Adds two rails that carry the body on skids, on a low bed with cross beams.
void add_conveyor(World& world, const FactoryDesign& design, double length) {
  const double at = 0.25 * design.car.width, half = design.rail_width / 2;
  for (const double v : {-at, at}) world.add_everywhere(v - half, v + half, 0.34, 0.46);
  world.add_everywhere(-at - 0.16, -at - 0.12, 0.1, 0.2);
  world.add_everywhere(at + 0.12, at + 0.16, 0.1, 0.2);
  for (double s = -12; s < length + 12; s += 1.5) {
    world.add(box(s, 0, 0.06, at + 0.2, 0, 0.3));
  }
}

/// Adds racks, machines, columns, robots, people, cables, lights and beams, floor to ceiling.
void furnish(World& world, const FactoryDesign& design, double length, std::uint64_t seed) {
  Dice dice(seed, kLayoutStream);
  add_conveyor(world, design, length);
  add_overhead(world, design, length, dice);
  add_rows(world, design, length, dice);
  add_fixtures(world, design, length, dice);
  add_guides(world, design, length, dice);
  for (const double s : {-14.5, length + 14.5}) {  // the end walls
    world.add(box(s, 0, 0.3, design.half_width, 0, design.height));
  }
}

constexpr double kRideHeight = 0.5;  // height of the body's lowest parts above the floor
constexpr double kScannerHeight = 1.9;
constexpr double kBlindHalfAngle = 0.3;  // radians from straight down, hidden by the platform
constexpr double kLeastAzimuth = 0.75;   // between the turning scan plane and the line's direction
constexpr double kRangeNoise = 0.002;
constexpr double kLineEnds = 4;  // stretch at each end of the line where the body does not go
constexpr double kTurn = 0.83;   // path along the line for a turn of the scan plane there and back

/// The plan of a scanner whose plane turns back and forth while its platform moves on.
ScanPlan factory_plan(const FactoryDesign& design, const Path& path, std::uint64_t points) {
  return {.points = points,
          .rays_a_sweep = rays_a_sweep(points, design.density_aspect),
          .reach = design.half_width * 1.1,
          .noise = kRangeNoise,
          .sweep = [&path](double share, std::uint64_t) {
            const double s = share * path.length();
            const double phase = s / kTurn - std::floor(s / kTurn);
            const double swing = phase < 0.5 ? 2 * phase : 2 - 2 * phase;
            const double azimuth = kLeastAzimuth + swing * (kPi - 2 * kLeastAzimuth);
            return Sweep{{s, 0, kScannerHeight},
                         sine_cosine(azimuth),
                         kBlindHalfAngle,
                         2 * kPi - kBlindHalfAngle};
          }};
}

/// A pose of the body, which rides on the conveyor and sways a little.
Pose body_pose(const Path& path, std::uint64_t number, std::uint64_t count) {
  const double s = along(kLineEnds, path.length() - kLineEnds, number, count);
  const double sway = 0.015 * sine_cosine(0.31 * s).sine + 0.01 * sine_cosine(0.83 * s + 1).sine;
  const double lift = 0.006 * sine_cosine(0.57 * s + 2).sine;
  const Attitude attitude{.yaw = 0.006 * sine_cosine(0.23 * s + 0.5).sine,
                          .pitch = 0.002 * sine_cosine(0.41 * s).sine,
                          .roll = 0.004 * sine_cosine(0.37 * s + 1.5).sine};
  return pose_along(path.to_world({s, sway, kRideHeight + lift}), path.direction(s), attitude);
}

std::unique_ptr<const Scene> make_factory(Kind kind, const FactoryDesign& design,
                                          const Sizes& sizes, std::uint64_t seed) {
  const Room room{.begin_s = 0,
                  .walls = {{0, -1, 0},
                            {0, 1, design.height},
                            {1, 0, design.half_width},
                            {-1, 0, design.half_width}}};
  auto scene = empty_scene(kind, sizes, Path::from_pieces(design.line, 0), {room});
  furnish(scene->world, design, scene->path.length(), seed);
  scene->plan = factory_plan(design, scene->path, sizes.points);
  return with_vehicle(std::move(scene), seed, car_body(design.car), 0, body_pose);
}

}  // namespace

std::unique_ptr<const Scene> make_hall(const Sizes& sizes, std::uint64_t seed) {
  constexpr double kBend = 1 / 16.0;
  const std::vector<PathPiece> line{{24, 0},     {4, kBend},   {10, kBend}, {4, 0}, {8, 0},
                                    {4, -kBend}, {10, -kBend}, {4, 0},      {20, 0}};
  const FactoryDesign design{.line = line,
                             .half_width = 12,
                             .height = 7,
                             .car = {4.5, 1.9, 1.5},
                             .rail_width = 0.14,
                             .fixture_spacing = 1.6,
                             .guide_gap = 8,
                             .density_aspect = 0.4};
  return make_factory(Kind::kHall, design, sizes, seed);
}

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
