#include "scene/sites/factory.hpp"

#include <cmath>

#include "scene/attitude.hpp"

namespace clearway::scene {
namespace {

constexpr double kRideHeight = 0.5;  // height of the body's lowest parts above the floor
constexpr double kScannerHeight = 1.9;
constexpr double kBlindHalfAngle = 0.3;  // radians from straight down, hidden by the platform
constexpr double kLeastAzimuth = 0.75;   // between the turning scan plane and the line's direction
constexpr double kRangeNoise = 0.002;
constexpr double kLineEnds = 4;  // stretch at each end of the line where the body does not go
constexpr double kTurn = 0.83;   // path along the line for a turn of the scan plane there and back

/// The plan of a scanner whose plane turns back and forth while its platform moves on.
ScanPlan factory_plan(const FactoryDesign& design, const Path& path, std::uint64_t points) {
  ScanPlan plan{.points = points,
                .rays_a_sweep = rays_a_sweep(points, design.density_aspect),
                .sweep = {},
                .reach = design.half_width * 1.1,
                .noise = kRangeNoise};
  const std::uint64_t sweeps = plan.sweeps();
  plan.sweep = [&path, sweeps](std::uint64_t number) {
    const double share = (static_cast<double>(number) + 0.5) / static_cast<double>(sweeps);
    const double s = share * path.length();
    const double phase = s / kTurn - std::floor(s / kTurn);
    const double swing = phase < 0.5 ? 2 * phase : 2 - 2 * phase;
    const double azimuth = kLeastAzimuth + swing * (kPi - 2 * kLeastAzimuth);
    return Sweep{
        {s, 0, kScannerHeight}, sine_cosine(azimuth), kBlindHalfAngle, 2 * kPi - kBlindHalfAngle};
  };
  return plan;
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

}  // namespace

std::unique_ptr<const Scene> make_factory(Kind kind, const FactoryDesign& design,
                                          const Sizes& sizes, std::uint64_t seed) {
  const Room room{.begin_s = 0,
                  .walls = {{0, -1, 0},
                            {0, 1, design.height},
                            {1, 0, design.half_width},
                            {-1, 0, design.half_width}}};
  auto scene = std::make_unique<Scene>(
      Scene{kind, sizes, Path::from_pieces(design.line, 0), World({room}), {}, {}, {}, {}});
  furnish(scene->world, design, scene->path.length(), seed);
  scene->plan = factory_plan(design, scene->path, sizes.points);
  scene->world.finish(scene->path, scene->plan.reach);
  scene->model = sample_mesh(
      car_body(design.car), sizes.model_points, 0, [](const Vec3&) { return 1.0; },
      Random(seed, kModelStream));
  scene->pose = [&path = scene->path, count = sizes.poses](std::uint64_t number) {
    return body_pose(path, number, count);
  };
  return scene;
}

}  // namespace clearway::scene
