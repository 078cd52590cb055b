#include "scene/sites/factory.hpp"

namespace clearway::scene {
namespace {

/// Where a piece of furniture stands: `side` is 1 on the left and -1 on the right of the line.
struct Spot {
  double s, v;
  double side;
};

Prism box(double s, double v, double half_length, double half_width, double bottom, double top) {
  return {.s = s,
          .v = v,
          .half_length = half_length,
          .half_width = half_width,
          .bottom = bottom,
          .top = top};
}

Prism pole(double s, double v, double radius, double bottom, double top) {
  Prism out = box(s, v, radius, radius, bottom, top);
  out.round = true;
  return out;
}

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
  switch (dice.choice(6)) {
    case 0:
      add_rack(world, spot, dice);
      break;
    case 1:
      add_machine(world, spot, dice);
      break;
    case 2:
      add_robot(world, spot, dice);
      break;
    case 3:
      add_person(world, spot, dice);
      break;
    case 4:
      add_trolley(world, spot, dice);
      break;
    default:
      add_crate(world, spot, dice);
  }
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
    const double side = dice.chance(0.5) ? 1 : -1;
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

}  // namespace

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

}  // namespace clearway::scene
