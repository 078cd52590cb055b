// Vehicles of several bodies against brute force, body by body, merged by hand.
#include <algorithm>

#include "library/vehicle_truth.hpp"
#include "support/catch.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("first poses and bodies are those of brute force for each body") {
  for (const std::uint64_t seed : {71, 72, 73}) {
    Vehicle vehicle(seed);
    check_first_poses(vehicle, {.threads = static_cast<int>(seed % 2 + 1)});
    const auto body = Result(vehicle.folder / "out.h5").first_body();
    // At some poses the third body is where the first one is, and the first one counts there.
    for (std::uint32_t i = 0; i < 3; ++i) CHECK(std::ranges::count(body, i) > 0);
  }
}

TEST_CASE("the set of a vehicle is that of all its bodies") {
  Vehicle vehicle(74);
  const auto expected = first_by_hand(vehicle);
  std::vector<std::uint64_t> colliding;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (expected[i].pose != kNever) colliding.push_back(i);
  }
  const Result result = vehicle.run();
  CHECK(result.source() == colliding);
  CHECK(result.first_body().empty());
  CHECK(result.bodies() == std::vector<std::string>{"front", "middle", "rear"});
  CHECK(result.poses() == vehicle.query.poses.size());
  CHECK(vehicle.report.model_points == 75);
}

TEST_CASE("bodies that move between poses have the ways of the path") {
  Vehicle vehicle(75, false);
  vehicle.query.between_poses = true;
  check_first_poses(vehicle);
}

TEST_CASE("clearances name the nearest body and of equals the lowest") {
  Vehicle vehicle(76);
  vehicle.query.first_pose = GENERATE(false, true);
  vehicle.query.clearance = GENERATE(0.03, 0.2);
  check_clearances(vehicle);
}

TEST_CASE("the profile of a vehicle is the least of its bodies") {
  Vehicle vehicle(77);
  vehicle.query.profile = 0.15;
  check_profile(vehicle);
}

TEST_CASE("a vehicle of one body on the path finds what its model finds") {
  Vehicle vehicle(78);
  vehicle.query.bodies.resize(1);
  vehicle.query.first_pose = true;
  vehicle.query.clearance = 0.1;
  const Result as_body = vehicle.run();
  const auto source = as_body.source();
  const auto pose = as_body.first_pose();
  const Clearances clearance = as_body.clearance();
  CHECK(std::ranges::count(as_body.first_body(), 0u) == static_cast<long>(source.size()));
  vehicle.query.model = vehicle.query.bodies[0].model;
  vehicle.query.bodies.clear();
  const Result as_model = vehicle.run({.engine = Engine::kSweep, .device = Device::kCpu});
  CHECK(as_model.source() == source);
  CHECK(as_model.first_pose() == pose);
  CHECK(as_model.clearance().distance == clearance.distance);
  CHECK(as_model.clearance().pose == clearance.pose);
  CHECK(as_model.bodies().empty());
  CHECK(as_model.clearance().body.empty());
}
