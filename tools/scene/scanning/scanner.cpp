#include "scene/scanning/scanner.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "scene/scanning/fan.hpp"
#include "scene/vector.hpp"

namespace clearway::scene {
namespace {

enum Stream : std::uint64_t { kJitter = 1, kRangeNoise = 2, kRoughness = 3 };

/// Added to the bounds of the nominal surfaces for what roughness and noise may add, metres.
constexpr double kBoundsMargin = 2;
constexpr double kAnyDistance = 1e9;
constexpr double kMetresToQuanta = 10000;
constexpr double kDownAngle = 1.43;  // radians, for rays that replace those lost to the sky

std::int32_t quantum(double metres) {
  return static_cast<std::int32_t>(std::floor(metres * kMetresToQuanta + 0.5));
}

/// The farthest that a hit may be from the path, sideways or in height.
double greatest_offset(const World& world, const ScanPlan& plan) {
  double out = plan.open_reach;
  for (const Room& room : world.rooms()) {
    for (const Wall& wall : room.walls) out = std::max(out, std::abs(wall.distance));
  }
  return out;
}

QuantumBox bounds_of(const Path& path, const World& world, const ScanPlan& plan) {
  const double margin = greatest_offset(world, plan) + kBoundsMargin;
  const double beyond = path.closed() ? 0 : plan.reach + kBoundsMargin;
  Vec3 lo = path.at(0).position, hi = lo;
  for (double s = -beyond; s <= path.length() + beyond; s += 0.5) {
    const Vec3 p = path.at(s).position;
    for (int k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], p[k] - margin);
      hi[k] = std::max(hi[k], p[k] + margin);
    }
  }
  return {{quantum(lo.x), quantum(lo.y), quantum(lo.z)},
          {quantum(hi.x), quantum(hi.y), quantum(hi.z)}};
}

}  // namespace

std::uint64_t rays_a_sweep(std::uint64_t points, double aspect) {
  const double rays = std::sqrt(static_cast<double>(points) * aspect);
  return std::max<std::uint64_t>(16, static_cast<std::uint64_t>(rays));
}

Scanner::Scanner(const Path& path, const World& world, ScanPlan plan, std::uint64_t seed)
    : path_(path),
      world_(world),
      plan_(std::move(plan)),
      jitter_(seed, kJitter),
      range_noise_(seed, kRangeNoise),
      rough_key_(Random(seed, kRoughness).bits(0)),
      bounds_(bounds_of(path, world, plan_)) {}

/// One ray's hit as a stored point.
std::array<std::int32_t, 3> Scanner::point(const Sweep& sweep, const Fan& fan, std::size_t k,
                                           std::uint64_t counter) const {
  double distance =
      1 / fan.inverse_distance(k) + plan_.noise * Random::to_normal(range_noise_.bits(counter));
  const auto at = [&](double range) {
    const double h = range * fan.ray_h(k);
    return PathPoint{sweep.scanner.s + h * sweep.azimuth.cosine,
                     sweep.scanner.v + h * sweep.azimuth.sine,
                     sweep.scanner.w + range * fan.ray_w(k)};
  };
  PathPoint hit = at(distance);
  const Wall* wall = fan.wall(k);
  const Roughness& rough = wall != nullptr ? wall->rough : fan.prism(k)->rough;
  if (!rough.none()) {
    const double s =
        path_.closed() ? hit.s - std::floor(hit.s / path_.length()) * path_.length() : hit.s;
    const double inwards = displacement(rough, rough_key_, s, hit.v, hit.w);
    if (wall != nullptr) {
      hit.v -= inwards * wall->normal_v;
      hit.w -= inwards * wall->normal_w;
    } else {
      hit = at(distance - inwards);
    }
  }
  const Vec3 world = path_.to_world(hit);
  std::array<std::int32_t, 3> out{};
  for (int i = 0; i < 3; ++i) {
    out[static_cast<std::size_t>(i)] = std::clamp(quantum(world[i]), bounds_.lo[i], bounds_.hi[i]);
  }
  return out;
}

void Scanner::scan(std::uint64_t number, Points& out) const {
  const Sweep sweep = plan_.sweep_of(number);
  const Room& room = world_.room_at(sweep.scanner.s);
  const std::uint64_t first = number * plan_.rays_a_sweep;
  const std::uint64_t count = std::min(plan_.rays_a_sweep, plan_.points - first);
  thread_local std::vector<Rectangle> rectangles;
  thread_local Fan fan;
  rectangles.clear();
  cut_prisms(world_.prisms_everywhere(), sweep.scanner, sweep.azimuth, rectangles);
  cut_prisms(world_.prisms_near(sweep.scanner.s, plan_.reach), sweep.scanner, sweep.azimuth,
             rectangles);
  std::uint64_t counter = first;
  const auto cast = [&](double begin, double end, std::uint64_t rays, double far) {
    fan.aim(begin, end, rays, jitter_, counter);
    fan.meet_room(room, sweep.scanner, sweep.azimuth);
    for (const Rectangle& rectangle : rectangles) fan.meet_rectangle(rectangle);
    const std::uint64_t before = out.size();
    for (std::size_t k = 0; k < rays; ++k) {
      if (fan.inverse_distance(k) * far > 1) out.push_back(point(sweep, fan, k, counter + k));
    }
    counter += rays;
    return rays - (out.size() - before);
  };
  const double farthest = room.open ? plan_.open_reach : kAnyDistance;
  const std::uint64_t lost = cast(sweep.begin_angle, sweep.end_angle, count, farthest);
  counter = ~first;  // other random numbers for the rays that replace those lost to the sky
  cast(0, kDownAngle, lost / 2, kAnyDistance);
  cast(2 * kPi - kDownAngle, 2 * kPi, lost - lost / 2, kAnyDistance);
}

}  // namespace clearway::scene
