// Vehicles of several bodies against brute force, body by body, merged by hand.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "api/vehicle_scene.hpp"
#include "core/geometry/predicate.hpp"
#include "core/query/hit_set.hpp"
#include "cpu/brute_force.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr std::uint32_t kNever = HitSet::kNever;

/// A pose of the path and a body; none: kNever.
struct First {
  std::uint32_t pose = kNever, body = kNever;
  friend bool operator<(const First& a, const First& b) {
    return a.pose != b.pose ? a.pose < b.pose : a.body < b.body;
  }
};

std::vector<First> first_by_hand(const Vehicle& vehicle) {
  std::vector<First> out(vehicle.places.size());
  for (std::uint32_t body = 0; body < vehicle.query.bodies.size(); ++body) {
    const auto poses = brute_force_first_poses(vehicle.places, vehicle.of(body));
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (poses[i] == kNever) continue;
      out[i] = std::min(out[i], First{vehicle.query.bodies[body].path_pose[poses[i]], body});
    }
  }
  return out;
}

void check_first_poses(Vehicle& vehicle, const SearchOptions& options = {}) {
  vehicle.query.first_pose = true;
  const Result result = vehicle.run(options);
  const auto expected = first_by_hand(vehicle);
  const auto source = result.source();
  const auto pose = result.first_pose(), body = result.first_body();
  std::size_t row = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (expected[i].pose == kNever) continue;
    REQUIRE(row < source.size());
    CHECK(source[row] == i);
    CHECK(pose[row] == expected[i].pose);
    CHECK(body[row] == expected[i].body);
    ++row;
  }
  CHECK(row == source.size());
  CHECK(row > 20);
}

}  // namespace

TEST_CASE("first poses and bodies are those of brute force for each body") {
  for (const std::uint64_t seed : {71, 72, 73}) {
    Vehicle vehicle(seed);
    check_first_poses(vehicle, {.threads = static_cast<int>(seed % 2 + 1)});
    const auto body = Result(vehicle.folder / "out.h5").first_body();
    // The third body is where the first one is at some poses: the first one counts there.
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
  const Clearances found = vehicle.run({.threads = 2}).clearance();
  struct Least {
    double squared = std::numeric_limits<double>::infinity();
    First first;
  };
  std::vector<Least> expected(vehicle.places.size());
  for (std::uint32_t body = 0; body < vehicle.query.bodies.size(); ++body) {
    const auto all = brute_force_clearances(vehicle.places, vehicle.of(body));
    for (std::size_t i = 0; i < all.size(); ++i) {
      const First first{vehicle.query.bodies[body].path_pose[all[i].pose], body};
      Least& least = expected[i];
      const bool nearer = all[i].squared < least.squared;
      if (nearer || (all[i].squared == least.squared && first < least.first)) {
        least = {all[i].squared, first};
      }
    }
  }
  std::size_t row = 0;
  const double limit = rounded_product(vehicle.query.clearance, vehicle.query.clearance);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (!(expected[i].squared < limit)) continue;
    REQUIRE(row < found.source.size());
    CHECK(found.source[row] == i);
    CHECK(found.distance[row] == std::sqrt(expected[i].squared));
    CHECK(found.pose[row] == expected[i].first.pose);
    CHECK(found.body[row] == expected[i].first.body);
    ++row;
  }
  CHECK(row == found.source.size());
  CHECK(row > 10);
}

TEST_CASE("the profile of a vehicle is the least of its bodies") {
  Vehicle vehicle(77);
  vehicle.query.profile = 0.15;
  const Profile found = vehicle.run({.threads = 2}).profile();
  std::vector<NearestPoint> expected(vehicle.query.poses.size(),
                                     {std::numeric_limits<double>::infinity(), Profile::kNoPoint});
  for (std::size_t body = 0; body < vehicle.query.bodies.size(); ++body) {
    const auto all = brute_force_profile(vehicle.places, vehicle.of(body));
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (std::isinf(all[k].squared)) continue;
      NearestPoint& least = expected[vehicle.query.bodies[body].path_pose[k]];
      const bool nearer = all[k].squared < least.squared;
      if (nearer || (all[k].squared == least.squared && all[k].source < least.source)) {
        least = all[k];
      }
    }
  }
  REQUIRE(found.distance.size() == expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    CHECK(found.distance[i] == std::sqrt(expected[i].squared));
    CHECK(found.source[i] == expected[i].source);
  }
  CHECK(vehicle.report.profile_poses > 10);
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
