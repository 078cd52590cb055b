#include <cmath>

#include "scene/sites/kinds.hpp"

/// Like El Teniente: galleries around a block of rock, scanned stop and go, and a front loader that
/// follows a B-spline through the stations (the paper, section 4.3).
namespace clearway::scene {
namespace {

constexpr int kStations = 44;
constexpr double kScannerHeight = 1.5;
// Radians from straight down: 40 degrees below the horizon to 60 above.
constexpr double kLowestRay = 0.87, kHighestRay = 2.62;
constexpr double kLeastAzimuth = 0.1;  // radians from the gallery's direction
constexpr double kRangeNoise = 0.003;
constexpr double kReach = 36;  // metres along the gallery, at the least azimuth
constexpr double kRideHeight = 0.08;
constexpr Roughness kRock{0.55, 3.0, 0.1, 0.35};
constexpr Roughness kFloor{0.08, 1.2, 0.02, 0.15};
constexpr Roughness kRubble{0.12, 0.4, 0.03, 0.1};

/// A loop of galleries, rounded where they meet.
Path gallery_loop(std::uint64_t seed) {
  Dice dice(seed, kShapeStream);
  std::vector<Vec3> control;
  const auto leg = [&](double x0, double y0, double x1, double y1, int count) {
    for (int i = 0; i < count; ++i) {
      const double f = (i + 0.5) / count;
      control.push_back({x0 + f * (x1 - x0) + dice.between(-1.2, 1.2),
                         y0 + f * (y1 - y0) + dice.between(-1.2, 1.2), dice.between(-0.5, 0.5)});
    }
  };
  leg(0, 0, 130, 0, 8);
  leg(145, 15, 145, 65, 4);
  leg(130, 80, 70, 85, 4);
  leg(60, 95, 55, 130, 3);
  leg(40, 145, 0, 145, 3);
  leg(-15, 130, -15, 15, 8);
  return Path::closed_spline(control);
}

/// The cross-section of a gallery: flat floor, upright sides and an arched roof, 4.6 m wide and 4.3
/// m high.
Room gallery() {
  constexpr double kHalf = 2.3, kSpring = 2.2, kRise = 2.1;
  Room room{.begin_s = 0, .walls = {{0, -1, 0, kFloor}}};
  constexpr int kSides = 14;
  for (int i = 0; i <= kSides; ++i) {  // tangents of the ellipse over the springing line
    const auto [nw, nv] = sine_cosine(kPi * i / kSides);
    const double support = std::sqrt(kHalf * kHalf * nv * nv + kRise * kRise * nw * nw);
    room.walls.push_back({nv, nw, support + nw * kSpring, kRock});
  }
  return room;
}

void add_fittings(World& world, double length, std::uint64_t seed) {
  Dice dice(seed, kLayoutStream);
  world.add_everywhere(0.6, 1.1, 3.25, 3.65);    // ventilation duct
  world.add_everywhere(-1.75, -1.65, 2.9, 3.0);  // water and air pipes
  world.add_everywhere(-1.62, -1.56, 3.05, 3.11);
  for (double s = 0; s < length; s += dice.between(1, 6)) {  // rubble along the sides
    const double side = random_side(dice), radius = dice.between(0.2, 0.6);
    const double v = side * dice.between(1.4, 2.2);
    world.add(pole(s, v, radius, -0.1, dice.between(0.15, 0.8), kRubble));
  }
  for (double s = 3; s < length; s += 6) {  // lamps
    world.add(box(s, -0.7, 0.15, 0.1, 3.7, 3.8));
  }
}

std::vector<double> place_stations(double length, std::uint64_t seed) {
  Dice dice(seed, kShapeStream + 1);
  std::vector<double> out;
  out.reserve(kStations);
  for (int i = 0; i < kStations; ++i) {
    out.push_back((i + 0.5 + dice.between(-0.2, 0.2)) * length / kStations);
  }
  return out;
}

/// The plan of a scanner that turns once about the vertical at each station, column by column.
ScanPlan station_plan(const std::vector<double>& stations, std::uint64_t points) {
  constexpr double kFan = kHighestRay - kLowestRay, kTurn = 2 * kPi - 4 * kLeastAzimuth;
  return {.points = points,
          .rays_a_sweep = rays_a_sweep((points + kStations - 1) / kStations, kFan / kTurn),
          .reach = kReach,
          .noise = kRangeNoise,
          .sweep = [&stations](double share, std::uint64_t) {
            const double turns = share * kStations, station = std::floor(turns);
            double azimuth = kLeastAzimuth + (turns - station) * kTurn;
            if (azimuth > kPi - kLeastAzimuth) azimuth += 2 * kLeastAzimuth;
            const double s = stations[static_cast<std::size_t>(station)];
            return Sweep{{s, 0, kScannerHeight}, sine_cosine(azimuth), kLowestRay, kHighestRay};
          }};
}

Pose loader_pose(const Path& path, std::uint64_t number, std::uint64_t count) {
  const double s = path.length() * (static_cast<double>(number) / static_cast<double>(count));
  const Attitude attitude{.pitch = 0.004 * sine_cosine(0.7 * s).sine,
                          .roll = 0.006 * sine_cosine(0.9 * s + 1).sine};
  return pose_along(path.to_world({s, 0, kRideHeight}), path.direction(s), attitude);
}

}  // namespace

std::unique_ptr<const Scene> make_mine(const Sizes& sizes, std::uint64_t seed) {
  auto scene = empty_scene(Kind::kMine, sizes, gallery_loop(seed), {gallery()});
  add_fittings(scene->world, scene->path.length(), seed);
  scene->stations = place_stations(scene->path.length(), seed);
  scene->plan = station_plan(scene->stations, sizes.points);
  return with_vehicle(std::move(scene), seed, front_loader(), 0, loader_pose);
}

}  // namespace clearway::scene
