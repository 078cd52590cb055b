// What a search says about the ground, floors and ignored points.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/questions.hpp"
#include "support/solid_scene.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Points 0.1 m apart in a rectangle of 16 m by 6 m that rises along x.
std::vector<Quantum> ground(double slope = 0) {
  std::vector<Quantum> points;
  for (int x = -3000; x <= 13000; x += 100) {
    const auto z = static_cast<std::int32_t>(std::lround(slope * x));
    for (int y = -3000; y <= 3000; y += 100) points.push_back({x, y, z});
  }
  return points;
}

/// What a search says about the ground and the floor before it begins.
std::vector<Message> told_about(const Query& query, const std::vector<Quantum>& points) {
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

/// The floor that a note about the ground names; none where nothing is said.
std::optional<double> floor_told(const Query& query,
                                 const std::vector<Quantum>& points = ground()) {
  const std::vector<Message> told = told_about(query, points);
  if (told.empty()) return std::nullopt;
  CHECK(told.size() == 1);
  CHECK(told[0].code == "ground-collides");
  CHECK(told[0].severity == Message::Severity::kNote);
  for (const auto& [name, value] : told[0].numbers) {
    if (std::string(name) == "floor") return value;
  }
  return std::nan("");
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

Query boxes_at(const std::vector<Box>& boxes, std::vector<Pose> poses) {
  Bodies bodies;
  for (const Box& box : boxes) bodies.add(box_surface(box));
  return bodies.query(std::move(poses), 0.1);
}

const Box kLorry{{-4, -1.2, 0}, {4, 1.2, 3}};

}  // namespace

TEST_CASE("questions that differ in a floor alone are told apart") {
  const AskedScan scan(41, true);
  Query query = scan.vehicle(1);
  query.floor = -0.02;
  searched(scan, query, "out.h5");
  const auto again = [&](std::optional<double> floor, const std::string& words) {
    query.floor = floor;
    check_refused([&] { search(Store(scan.store), query, scan.folder / "out.h5", {.threads = 1}); },
                  words);
  };
  again(-0.01, "floor: -0.02 m in the file, -0.01 m here");
  again(std::nullopt, "floor: -0.02 m in the file, none here");
  query.bodies[0].floor = -0.03;
  again(-0.02, "model: ");
}

TEST_CASE("the ground under a vehicle is told before the search, with the floor to take") {
  CHECK(floor_told(boxes_at({kLorry}, drive(0))) == Approx(0.05));
  CHECK(floor_told(boxes_at({kLorry}, drive(-0.12))) == Approx(0.15));
  // A model of points, whose wheels alone reach the ground.
  Query wheels({}, drive(0), {0.1});
  for (const double x : {-3.0, 3.0}) {
    for (int i = 0; i <= 40; ++i) {
      wheels.model.vertices.push_back({x, -1, 0.05 * i});
      wheels.model.vertices.push_back({x + 0.05, 1, 0.05 * i});
    }
  }
  CHECK(floor_told(wheels) == Approx(0.05));
  const Query climbing = boxes_at({kLorry}, drive(0, std::atan(0.1)));
  CHECK(floor_told(climbing, ground(0.1)).value() > 0);
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
  std::vector<Box> wagon{{{-6, -1.4, 0.4}, {6, 1.4, 3.8}}};  // the body, above the wheels
  for (const double x : {-5.0, -3.2, 3.2, 5.0}) {
    for (const double y : {-0.75, 0.67}) {  // wheels with flanges
      wagon.push_back({{x - 0.4, y, -0.03}, {x + 0.4, y + 0.08, 0.9}});
    }
  }
  Query query = boxes_at(wagon, path);
  query.floor = floor_told(query, track);
  CHECK(query.floor == Approx(0.05));
  CHECK_FALSE(floor_told(query, track));
  // The same track as the runway of a crane, far above its load.
  CHECK_FALSE(floor_told(boxes_at({{{-1, -1, -4}, {1, 1, -2}}}, path), track));
}

TEST_CASE("sound questions hear nothing about the ground") {
  Query query = boxes_at({kLorry}, drive(0));
  std::vector<Quantum> points = ground();
  SECTION("with a floor") { query.floor = 0.3; }
  SECTION("with a high floor") { query.floor = 0.9; }
  SECTION("a load that hangs") { query.poses = drive(0.5); }
  SECTION("without the ground") { query.ignore_boxes = {{{0, -1000, -1}, {1000, 0, 0.01}}}; }
  SECTION("a wall beside it") {
    points.clear();
    for (int x = -3000; x <= 13000; x += 50) {
      for (int z = 0; z <= 3000; z += 50) points.push_back({x, 1250, z});
    }
  }
  SECTION("a floor below a model above the ground") {
    query.poses = drive(1);
    query.floor = 0.2;
  }
  CHECK(told_about(query, points).empty());
}

TEST_CASE("a floor that is no height above the ground is warned of, or refused") {
  Query query = boxes_at({kLorry}, drive(1));
  query.floor = 0.2;
  for (Pose& pose : query.poses) pose = rotation({1, 0, 0}, 1.5708, pose.position());
  const auto only_text = [&] {
    const auto told = told_about(query, ground());
    REQUIRE(told.size() == 1);
    return told[0].text;
  };
  check_says(only_text(), "at 20 of 20 poses the z axis is more than 45 degrees");
  // The origin of the model's file is in its middle.
  query = boxes_at({{{-4, -1.2, -1.5}, {4, 1.2, 1.5}}}, drive(1.5));
  query.floor = 0.25;
  check_says(only_text(), "the floor is 1.75 m above the lowest part of the model");
  query = boxes_at({kLorry}, drive(0));
  query.floor = 3.2;
  check_refused([&] { told_about(query, ground()); },
                "with a floor of 3.2 m nothing can collide: the model reaches from 0 to 3 m of "
                "its frame");
}

TEST_CASE("ignored points that would collide are warned of, below a floor only high ones") {
  const AskedScan scan(41);
  Random random(8);
  Query query(scan.models[1], AskedScan::path(random, 20), {.radius = 0.08});
  query.ignore_classes = {0, 1, 3};
  const auto report_with = [&](const SearchOptions& options) {
    return search(Store(scan.store), query, scan.folder / "out.h5", options);
  };
  const SearchReport plain = report_with({.threads = 1});
  CHECK(plain.ignored_colliding > plain.colliding_points);
  const std::string codes = codes_of(plain.warnings);
  CHECK_THAT(codes, Contains("ignored-collide") && Contains("ignored-high"));

  // Only the search itself can give these warnings, so that they are no reason not to search.
  const auto others = std::ranges::count_if(
      plain.warnings, [](const Message& warning) { return !warning.code.starts_with("ignored-"); });
  const SearchOptions strict{.threads = 1, .overwrite = true, .strict = true};
  if (others == 0) {
    CHECK_NOTHROW(report_with(strict));
  } else {
    CHECK_THROWS_WITH(report_with(strict),
                      Contains("strict: " + std::to_string(others)) && !Contains("ignored-"));
  }
  query.floor = -1e3;  // below everything
  const SearchReport above = report_with({.threads = 1, .overwrite = true});
  CHECK_THAT(codes_of(above.warnings), !Contains("ignored-collide") && Contains("ignored-high"));
  CHECK(above.colliding_points == plain.colliding_points);
}
