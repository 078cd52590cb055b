// Vehicles whose bodies are solids, beside surfaces and points, against brute force.
#include <algorithm>
#include <atomic>

#include "clearway/error.hpp"
#include "io/result/result.hpp"
#include "library/vehicle_truth.hpp"
#include "support/catch.hpp"
#include "support/solid_scene.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

Surface ball(const Vec3& at) {
  return mapped(unit_sphere(1), [&](const Vec3& v) { return plus(at, 0.35, v); });
}

/// Keeps every fourth pose of a body, so far apart that what is inside at one of them need not
/// touch the surface at another.
void keep_some_poses(Body& body) {
  const Body all = body;
  body.poses.clear();
  body.path_pose.clear();
  for (std::size_t i = 0; i < all.poses.size(); ++i) {
    if (all.path_pose[i] % 4 != 0) continue;
    body.poses.push_back(all.poses[i]);
    body.path_pose.push_back(all.path_pose[i]);
  }
}

/// A vehicle whose first and last body are the same two solids and an open triangle, and tie at
/// some poses. The second body has points, or the triangles between them.
struct SolidVehicle : Vehicle {
  explicit SolidVehicle(std::uint64_t seed, bool surface_too = false) : Vehicle(seed) {
    Bodies parts;
    parts.add(box_surface({{-0.3, -0.2, -0.1}, {0.3, 0.2, 0.3}}));
    parts.add(ball({0.2, 0.1, 0.2}));
    parts.add({{{0, 0, -0.2}, {0.4, 0, -0.2}, {0, 0.4, -0.2}}, {{0, 1, 2}}}, false);
    for (const std::size_t body : {0, 2}) {
      query.bodies[body].model = parts.surface.vertices;
      query.bodies[body].model.triangles = parts.surface.triangles;
      query.bodies[body].model.solid_of = parts.solid_of;
      keep_some_poses(query.bodies[body]);
    }
    if (surface_too) make_surface(1);
    query.radius = 0.02;
  }
};

}  // namespace

TEST_CASE("bodies of solids and bodies of points or surfaces are searched together") {
  for (const bool surface_too : {false, true}) {
    SolidVehicle vehicle(91, surface_too);
    const std::uint64_t found = vehicle.run({.threads = 2}).size();
    check_first_poses(vehicle, {.threads = 2});
    CHECK(vehicle.report.colliding_points == found);
    CHECK(vehicle.report.model_solids == 4);
    const auto body = Result(vehicle.folder / "out.h5").first_body();
    for (std::uint32_t i = 0; i < 3; ++i) CHECK(std::ranges::count(body, i) > 0);
    for (Body& surface : vehicle.query.bodies) surface.model.solid_of.clear();
    vehicle.query.first_pose = false;
    CHECK(vehicle.run().size() < found);
  }
}

TEST_CASE("depths in the solids of a vehicle are those of brute force") {
  SolidVehicle vehicle(92);
  vehicle.query.clearance = 0.1;
  check_clearances(vehicle);
  const auto distances = Result(vehicle.folder / "out.h5").clearance().distance;
  const auto inside = std::ranges::count_if(distances, [](double d) { return d < 0; });
  CHECK(inside > 10);
  CHECK(vehicle.report.inside_points == static_cast<std::uint64_t>(inside));
  vehicle.query.first_pose = true;
  check_clearances(vehicle);
  vehicle.query.first_pose = false;
  vehicle.query.clearance = 0;
  vehicle.query.profile = 0.1;
  check_profile(vehicle);
  const auto depths = Result(vehicle.folder / "out.h5").profile().distance;
  CHECK(std::ranges::count_if(depths, [](double d) { return d < 0; }) > 5);
}

TEST_CASE("ignored points are in no solid of a vehicle") {
  SolidVehicle vehicle(93, true);
  vehicle.query.ignore_boxes = {{{100.9995, -199.5005, -1}, {102.5005, -198.2995, 0.6005}}};
  check_first_poses(vehicle);
  vehicle.query.clearance = 0.1;
  check_clearances(vehicle);
}

TEST_CASE("merged shards and resumed searches of solid bodies have the bytes of the whole") {
  SolidVehicle vehicle(94);
  vehicle.query.first_pose = true;
  vehicle.query.clearance = vehicle.query.profile = 0.1;
  vehicle.run();
  const std::string whole = bytes_of(vehicle.folder / "out.h5");
  const Store store(vehicle.folder / "scan.h5");
  std::vector<std::filesystem::path> parts;
  for (std::uint32_t number = 1; number <= 3; ++number) {
    parts.push_back(vehicle.folder / ("part" + std::to_string(number) + ".h5"));
    search(store, vehicle.query, parts.back(), {.threads = 1, .shard = Shard{number, 3}});
  }
  const MergeReport merged = merge(parts, vehicle.folder / "merged.h5");
  CHECK(bytes_of(vehicle.folder / "merged.h5") == whole);
  CHECK(merged.model_solids == 4);
  CHECK(merged.inside_points == vehicle.report.inside_points);
  std::atomic<bool> stop = false;
  SearchOptions options{.threads = 1, .journal_interval_seconds = 0};
  options.progress = [&stop](const ProgressUpdate& update) {
    if (update.stage == "search" && update.done > update.total / 2) stop = true;
  };
  options.stop = &stop;
  const auto output = vehicle.folder / "resumed.h5";
  CHECK_THROWS_AS(search(store, vehicle.query, output, options), Interrupted);
  const SearchReport report = search(store, vehicle.query, output, {.threads = 1, .resume = true});
  CHECK(report.resumed_cells > 0);
  CHECK(bytes_of(output) == whole);
}

TEST_CASE("a vehicle's result knows its solids") {
  SolidVehicle vehicle(95);
  vehicle.run();
  const ResultHeader header = Result(vehicle.folder / "out.h5").reader().header();
  CHECK(header.model_solids == 4);
  vehicle.query.bodies[2].model.solid_of.clear();
  vehicle.run();
  const ResultHeader other = Result(vehicle.folder / "out.h5").reader().header();
  CHECK(other.model_solids == 2);
  CHECK(other.model_hash != header.model_hash);
}

TEST_CASE("solids that are not those of a body are refused by its name") {
  SolidVehicle vehicle(96);
  vehicle.query.bodies[2].model.solid_of.pop_back();
  CHECK_THROWS_WITH(vehicle.run(), Contains("body rear has") && Contains("the solids of"));
  vehicle.query.bodies[2].model.solid_of.push_back(1000);
  CHECK_THROWS_WITH(vehicle.run(), Contains("body rear names solid 1000"));
}
