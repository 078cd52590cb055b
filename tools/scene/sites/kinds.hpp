#pragma once

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "scene/scene.hpp"
#include "scene/vehicles/vehicles.hpp"

/// One function makes each kind of scene; make_scene of scene.hpp chooses.
namespace clearway::scene {

std::unique_ptr<const Scene> make_hall(const Sizes& sizes, std::uint64_t seed);
std::unique_ptr<const Scene> make_plant(const Sizes& sizes, std::uint64_t seed);
std::unique_ptr<const Scene> make_mine(const Sizes& sizes, std::uint64_t seed);
std::unique_ptr<const Scene> make_tunnel(const Sizes& sizes, std::uint64_t seed);
std::unique_ptr<const Scene> make_road(const Sizes& sizes, std::uint64_t seed);

/// Streams of random numbers; the scanner has the streams 1 to 3.
enum Stream : std::uint64_t { kModelStream = 10, kLayoutStream = 11, kShapeStream = 12 };

/// The place of pose `number` of `count` on the way from begin to end, both reached.
inline double along(double begin, double end, std::uint64_t number, std::uint64_t count) {
  if (count < 2) return (begin + end) / 2;
  return begin + (end - begin) * (static_cast<double>(number) / static_cast<double>(count - 1));
}

/// A scene whose world is to be furnished.
inline std::unique_ptr<Scene> empty_scene(Kind kind, const Sizes& sizes, Path path,
                                          std::vector<Room> rooms) {
  return std::make_unique<Scene>(
      Scene{kind, sizes, std::move(path), World(std::move(rooms)), {}, {}, {}, {}});
}

/// Finishes a scene whose world and plan are there. The model is the mesh, sampled with the noise
/// and the density of sample_mesh.
inline std::unique_ptr<const Scene> with_vehicle(
    std::unique_ptr<Scene> scene, std::uint64_t seed, const Mesh& mesh, double noise,
    Pose (*pose)(const Path& path, std::uint64_t number, std::uint64_t count),
    double (*density)(const Vec3&) = [](const Vec3&) { return 1.0; }) {
  scene->world.finish(scene->path, scene->plan.reach);
  scene->model =
      sample_mesh(mesh, scene->sizes.model_points, noise, density, Random(seed, kModelStream));
  scene->pose = [&path = scene->path, count = scene->sizes.poses, pose](std::uint64_t number) {
    return pose(path, number, count);
  };
  return scene;
}

/// 1 or -1, for the left or the right of the path.
inline double random_side(Dice& dice) { return dice.chance(0.5) ? 1 : -1; }

/// The plan of a scanner with two crossed planes, which is at place(share) of the path at a share
/// of the time. Rays that hit nothing within the reach turn down.
template <typename Place>
ScanPlan crossed_planes(std::uint64_t points, double height, double reach, Place place) {
  return {.points = points,
          .rays_a_sweep = rays_a_sweep(points, 0.05),
          .reach = reach,
          .noise = 0.004,
          .open_reach = reach,
          .sweep = [place, height](double share, std::uint64_t number) {
            const double azimuth = number % 2 == 0 ? kPi / 4 : 3 * kPi / 4;
            return Sweep{{place(share), 0, height}, sine_cosine(azimuth), 0, 2 * kPi};
          }};
}

}  // namespace clearway::scene
