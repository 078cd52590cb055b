// Vehicles whose bodies are surfaces, beside points, and vehicles whose search ignores points.
#include <algorithm>

#include "clearway/error.hpp"
#include "io/result/result.hpp"
#include "library/vehicle_truth.hpp"
#include "support/catch.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A vehicle two of whose bodies are the same surface and tie at some poses.
struct SurfaceVehicle : Vehicle {
  explicit SurfaceVehicle(std::uint64_t seed) : Vehicle(seed) {
    make_surface(0);
    make_surface(2);
  }
};

Box middle_box() { return {{100.9995, -199.5005, -1}, {102.5005, -198.2995, 0.6005}}; }

}  // namespace

TEST_CASE("bodies of triangles and bodies of points are searched together") {
  for (const std::uint64_t seed : {84, 85}) {
    SurfaceVehicle vehicle(seed);
    check_first_poses(vehicle, {.threads = 2});
    CHECK(vehicle.report.model_triangles == 16);
    const auto body = Result(vehicle.folder / "out.h5").first_body();
    for (std::uint32_t i = 0; i < 3; ++i) CHECK(std::ranges::count(body, i) > 0);
  }
}

TEST_CASE("clearances and profiles of a vehicle with surfaces are those of brute force") {
  SurfaceVehicle vehicle(86);
  vehicle.query.clearance = 0.15;
  check_clearances(vehicle);
  vehicle.query.clearance = 0;
  vehicle.query.profile = 0.15;
  check_profile(vehicle);
}

TEST_CASE("a vehicle's result knows what its bodies consist of") {
  SurfaceVehicle vehicle(87);
  vehicle.run();
  const Result surfaces(vehicle.folder / "out.h5");
  const ResultHeader header = surfaces.reader().header();
  CHECK(header.model_triangles == 16);
  for (Body& body : vehicle.query.bodies) body.model.triangles.clear();
  vehicle.run();
  const ResultHeader points = Result(vehicle.folder / "out.h5").reader().header();
  CHECK(points.model_triangles == 0);
  CHECK(points.model_hash != header.model_hash);
}

TEST_CASE("a vehicle with a surface has no motion between poses") {
  Vehicle vehicle(88, false);
  vehicle.make_surface(2);
  vehicle.query.between_poses = true;
  CHECK_THROWS_WITH(vehicle.run(),
                    Contains("motion between poses is searched for models of points"));
  vehicle.query.bodies[2].model.triangles.back()[1] = 25;
  vehicle.query.between_poses = false;
  CHECK_THROWS_WITH(vehicle.run(), Contains("of body rear has the corner 25"));
}

TEST_CASE("a vehicle touches no point that the search ignores") {
  SurfaceVehicle vehicle(89);
  vehicle.query.ignore_boxes = {middle_box()};
  check_first_poses(vehicle);
  const ResultHeader header = Result(vehicle.folder / "out.h5").reader().header();
  CHECK(header.ignored.points > 100);
  CHECK(header.bodies.size() == 3);
  CHECK(vehicle.report.ignored.points == header.ignored.points);
  vehicle.query.first_pose = false;
  vehicle.query.clearance = 0.15;
  check_clearances(vehicle);
  vehicle.query.clearance = 0;
  vehicle.query.profile = 0.15;
  check_profile(vehicle);
}

TEST_CASE("merged shards of a vehicle that ignores points have the bytes of the whole search") {
  SurfaceVehicle vehicle(90);
  vehicle.query.first_pose = true;
  vehicle.query.clearance = vehicle.query.profile = 0.1;
  vehicle.query.ignore_boxes = {middle_box()};
  vehicle.run();
  std::vector<std::filesystem::path> parts;
  for (std::uint32_t number = 1; number <= 3; ++number) {
    parts.push_back(vehicle.folder / ("part" + std::to_string(number) + ".h5"));
    search(Store(vehicle.folder / "scan.h5"), vehicle.query, parts.back(),
           {.threads = 1, .shard = Shard{number, 3}});
  }
  merge(parts, vehicle.folder / "merged.h5");
  CHECK(bytes_of(vehicle.folder / "merged.h5") == bytes_of(vehicle.folder / "out.h5"));
}
