// Searches with a floor against brute force: vehicles, what is left out, parts, sessions, and the
// look for the ground before a search.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "clearway/session.hpp"
#include "core/geometry/inside.hpp"
#include "library/vehicle_scene.hpp"
#include "library/vehicle_truth.hpp"
#include "support/catch.hpp"
#include "support/solid_scene.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A floor for the vehicle, and one of its own for a body.
void give_floors(Vehicle& vehicle, std::uint64_t seed) {
  Random random(seed);
  vehicle.query.floor = uniform(random, -0.1, 0.02);
  vehicle.query.bodies[seed % 3].floor = uniform(random, -0.1, 0.02);
}

/// Which points the bodies touch, with the radius and the floors changed by `more` metres.
std::vector<bool> touched_by_hand(const Vehicle& vehicle, double more, bool with_floors) {
  std::vector<bool> out(vehicle.places.size());
  for (std::size_t body = 0; body < vehicle.query.bodies.size(); ++body) {
    Query one = vehicle.of(body);
    one.radius += more;
    if (one.floor) *one.floor -= more;
    if (!with_floors) one.floor.reset();
    const auto poses = brute_force_first_poses(vehicle.searched_places(), one);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (poses[i] != kNever) out[i] = true;
    }
  }
  return out;
}

/// How many points would collide without floors and neither collide nor are near.
std::uint64_t below_by_hand(const Vehicle& vehicle, double near) {
  const auto all = touched_by_hand(vehicle, 0, false);
  const auto judged = touched_by_hand(vehicle, near, true);
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < all.size(); ++i) count += all[i] && !judged[i];
  return count;
}

/// A flat ground of points at height 0.
std::vector<Quantum> ground() {
  std::vector<Quantum> points;
  for (int x = -3000; x <= 13000; x += 100) {
    for (int y = -3000; y <= 3000; y += 100) points.push_back({x, y, 0});
  }
  return points;
}

/// What a search of a model on the ground says before it searches, and its numbers.
std::vector<Message> told_about(const Query& query, std::vector<Quantum> points = ground()) {
  ScratchFolder folder;
  write_las(folder / "scan.las", points);
  convert({folder / "scan.las"}, folder / "scan.h5", {.threads = 2});
  std::vector<Message> told;
  SearchOptions options{.device = Device::kCpu, .threads = 2};
  options.message = [&](const Message& message) {
    for (const char* code : {"ground-collides", "floor-axis", "floor-high"}) {
      if (message.code == code) told.push_back(message);
    }
  };
  search(Store(folder / "scan.h5"), query, folder / "out.h5", options);
  return told;
}

/// Poses along x at some height above the middle of the ground.
std::vector<Pose> drive(double z, double pitch = 0) {
  std::vector<Pose> out;
  for (int i = 0; i < 20; ++i) {
    const double x = 100 + 0.4 * i;
    out.push_back(rotation({0, 1, 0}, -pitch, {x, -200, z + 0.4 * i * std::tan(pitch)}));
  }
  return out;
}

Query box_at(const Box& box, std::vector<Pose> poses, double radius = 0.1) {
  Bodies bodies;
  bodies.add(box_surface(box));
  return bodies.query(std::move(poses), radius);
}

const Box kLorry{{-4, -1.2, 0}, {4, 1.2, 3}};

}  // namespace

TEST_CASE("first poses, clearances and profiles of bodies with floors are those of brute force") {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    Vehicle vehicle(seed);
    give_floors(vehicle, seed);
    if (seed % 2 == 0) vehicle.make_surface(seed % 3);
    check_first_poses(vehicle);
    vehicle.query.clearance = 0.15;
    check_clearances(vehicle);
    vehicle.query.profile = 0.3;
    check_profile(vehicle);
  }
}

TEST_CASE("what would collide below the floors is counted") {
  std::uint64_t sum = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    CAPTURE(seed);
    Vehicle vehicle(seed, false);
    give_floors(vehicle, seed);
    if (seed % 2 == 0) {
      vehicle.query.error_scan = 0.004;
      vehicle.query.error_pose = 0.003;
    }
    if (seed % 3 == 0) vehicle.query.ignore_boxes = {{{100, -200, 0}, {102, -198.5, 0.6}}};
    if (seed % 4 == 1) vehicle.query.between_poses = true;
    vehicle.query.first_pose = seed % 3 == 1;
    const Result result = vehicle.run();
    const auto& budget = vehicle.report.budget;
    const double near =
        budget ? budget->near_radius(vehicle.query.radius) - vehicle.query.radius : 0.0;
    const std::uint64_t expected = below_by_hand(vehicle, near);
    CHECK(vehicle.report.floor_colliding == expected);
    CHECK(result.answer().floor_colliding == expected);
    sum += expected;
    if (budget) {
      const double less = budget->certain_radius(vehicle.query.radius) - vehicle.query.radius;
      const auto certain = touched_by_hand(vehicle, less, true);
      CHECK(vehicle.report.certain.points ==
            static_cast<std::uint64_t>(std::ranges::count(certain, true)));
      CHECK(vehicle.report.certain.points > 0);
    }

    std::uint64_t of_parts = 0;
    std::vector<std::filesystem::path> parts;
    for (std::uint32_t number = 1; number <= 3; ++number) {
      SearchOptions options{.device = Device::kCpu, .threads = 2, .shard = Shard{number, 3}};
      parts.push_back(vehicle.folder / ("part" + std::to_string(number) + ".h5"));
      options.overwrite = true;
      of_parts += search(Store(vehicle.folder / "scan.h5"), vehicle.query, parts.back(), options)
                      .floor_colliding.value();
    }
    CHECK(of_parts == expected);
    merge(parts, vehicle.folder / "merged.h5", {.overwrite = true});
    CHECK(bytes_of(vehicle.folder / "merged.h5") == bytes_of(vehicle.folder / "out.h5"));

    const Session session(vehicle.folder / "scan.h5", {.device = Device::kCpu, .threads = 2});
    const SessionAnswer answer = session.search(vehicle.query);
    answer.save(vehicle.folder / "saved.h5", true);
    CHECK(bytes_of(vehicle.folder / "saved.h5") == bytes_of(vehicle.folder / "out.h5"));
  }
  CHECK(sum > 30);
}

TEST_CASE("questions that differ in a floor alone are told apart") {
  Vehicle vehicle(1);
  vehicle.query.floor = -0.02;
  const std::uint64_t with = vehicle.run().answer().colliding_points;
  SearchOptions options{.device = Device::kCpu, .threads = 1};
  const Store store(vehicle.folder / "scan.h5");
  const auto again = [&] { search(store, vehicle.query, vehicle.folder / "out.h5", options); };
  vehicle.query.floor = -0.01;
  CHECK_THROWS_WITH(again(), Contains("floor: -0.02 m in the file, -0.01 m here"));
  vehicle.query.floor.reset();
  CHECK_THROWS_WITH(again(), Contains("floor: -0.02 m in the file, none here"));
  vehicle.query.floor = -0.02;
  vehicle.query.bodies[0].floor = -0.03;
  CHECK_THROWS_WITH(again(), Contains("model: "));
  CHECK(with > 0);
}

TEST_CASE("a rotation without inverse and a floor that is no number are refused") {
  Vehicle vehicle(2);
  vehicle.query.floor = 0;
  vehicle.query.bodies[1].poses[3].rotation[8] = vehicle.query.bodies[1].poses[3].rotation[5] =
      vehicle.query.bodies[1].poses[3].rotation[2] = 0;
  CHECK_THROWS_WITH(vehicle.run(), Contains("body middle: the rotation of pose 3 has no inverse"));
  vehicle.query.floor = std::nan("");
  CHECK_THROWS_WITH(vehicle.run(), Contains("the floor is nan, expected a finite number"));
}

TEST_CASE("the ground under a vehicle is told before the search, with the floor to take") {
  const auto floor_of = [](const std::vector<Message>& told) {
    REQUIRE(told.size() == 1);
    CHECK(told[0].severity == Message::Severity::kNote);
    for (const auto& [name, value] : told[0].numbers) {
      if (std::string(name) == "floor") return value;
    }
    return std::nan("");
  };
  CHECK(floor_of(told_about(box_at(kLorry, drive(0)))) == Approx(0.05));
  CHECK(floor_of(told_about(box_at(kLorry, drive(-0.12)))) == Approx(0.15));
  // A model of points, whose wheels alone reach the ground.
  Query wheels({}, drive(0), {0.1});
  for (const double x : {-3.0, 3.0}) {
    for (int i = 0; i <= 40; ++i) {
      wheels.model.vertices.push_back({x, -1, 0.05 * i});
      wheels.model.vertices.push_back({x + 0.05, 1, 0.05 * i});
    }
  }
  CHECK(floor_of(told_about(wheels)) == Approx(0.05));
  // On a ramp.
  std::vector<Quantum> ramp = ground();
  for (Quantum& q : ramp) q[2] = static_cast<std::int32_t>(std::lround(0.1 * q[0]));
  CHECK(floor_of(told_about(box_at(kLorry, drive(0, std::atan(0.1))), ramp)) > 0);
}

TEST_CASE("a wagon on rails is told of the rails, and one that hangs from a rail is not") {
  // Rails whose heads are at height 0, and ballast 0.2 m below them.
  std::vector<Quantum> track;
  for (int x = -3000; x <= 13000; x += 50) {
    for (const int y : {-2720, -2690, -1310, -1280}) track.push_back({x, y, 0});
    for (int y = -4000; y <= 0; y += 100) track.push_back({x, y, -200});
  }
  std::vector<Pose> path = drive(0);
  for (Pose& pose : path) pose.translation[1] -= 2;
  Bodies wagon;
  wagon.add(box_surface({{-6, -1.4, 0.4}, {6, 1.4, 3.8}}));  // the body, above the wheels
  for (const double x : {-5.0, -3.2, 3.2, 5.0}) {
    for (const double y : {-0.75, 0.67}) {  // wheels with flanges
      wagon.add(box_surface({{x - 0.4, y, -0.03}, {x + 0.4, y + 0.08, 0.9}}));
    }
  }
  const std::vector<Message> told = told_about(wagon.query(path, 0.1), track);
  REQUIRE(told.size() == 1);
  CHECK(told[0].code == "ground-collides");
  Query with = wagon.query(path, 0.1);
  for (const auto& [name, value] : told[0].numbers) {
    if (std::string(name) == "floor") with.floor = value;
  }
  REQUIRE(with.floor);
  CHECK(*with.floor == Approx(0.05));
  CHECK(told_about(with, track).empty());

  // The same track as the runway of a crane, far above its load.
  Bodies load;
  load.add(box_surface({{-1, -1, -4}, {1, 1, -2}}));
  CHECK(told_about(load.query(path, 0.1), track).empty());
}

TEST_CASE("sound questions hear nothing about the ground") {
  Query query = box_at(kLorry, drive(0));
  SECTION("with a floor") { query.floor = 0.3; }
  SECTION("a load that hangs") { query.poses = drive(0.5); }
  SECTION("without the ground") { query.ignore_boxes = {{{0, -1000, -1}, {1000, 0, 0.01}}}; }
  SECTION("a wall beside it") {
    std::vector<Quantum> wall;
    for (int x = -3000; x <= 13000; x += 50) {
      for (int z = 0; z <= 3000; z += 50) wall.push_back({x, 1250, z});
    }
    CHECK(told_about(query, wall).empty());
    return;
  }
  CHECK(told_about(query).empty());
}

TEST_CASE("a floor along an axis that does not point up is warned of") {
  Query query = box_at(kLorry, drive(1));
  query.floor = 0.2;
  CHECK(told_about(query).empty());
  for (Pose& pose : query.poses) pose = rotation({1, 0, 0}, 1.5708, pose.position());
  const auto told = told_about(query);
  REQUIRE(told.size() == 1);
  CHECK_THAT(told[0].text, Contains("at 20 of 20 poses the z axis is more than 45 degrees"));
}

TEST_CASE("a floor above the model is refused, and one that leaves out much of it is warned of") {
  Query query = box_at(kLorry, drive(0));
  query.floor = 3.2;
  CHECK_THROWS_WITH(told_about(query),
                    "with a floor of 3.2 m nothing can collide: the model reaches from 0 to 3 m of "
                    "its frame");
  query.floor = 0.9;
  CHECK(told_about(query).empty());
  // The origin of the model's file is in its middle.
  query = box_at({{-4, -1.2, -1.5}, {4, 1.2, 1.5}}, drive(1.5));
  query.floor = 0.25;
  const auto told = told_about(query);
  REQUIRE(told.size() == 1);
  CHECK_THAT(told[0].text, Contains("the floor is 1.75 m above the lowest part of the model"));
}
