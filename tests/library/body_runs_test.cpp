// Runs of vehicles: shards, journals, memory, and what is refused.
#include <algorithm>
#include <atomic>
#include <limits>

#include "clearway/error.hpp"
#include "library/vehicle_scene.hpp"
#include "support/catch.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("merged shards of a vehicle have the bytes of the search of everything") {
  Vehicle vehicle(79);
  vehicle.query.first_pose = true;
  vehicle.query.clearance = vehicle.query.profile = 0.1;
  vehicle.run();
  const std::string whole = bytes_of(vehicle.folder / "out.h5");
  std::vector<std::filesystem::path> parts;
  for (std::uint32_t number = 1; number <= 4; ++number) {
    parts.push_back(vehicle.folder / ("part" + std::to_string(number) + ".h5"));
    search(Store(vehicle.folder / "scan.h5"), vehicle.query, parts.back(),
           {.threads = 1, .shard = Shard{number, 4}});
  }
  const MergeReport report = merge(parts, vehicle.folder / "merged.h5");
  CHECK(bytes_of(vehicle.folder / "merged.h5") == whole);
  CHECK(report.bodies.size() == 3);
  const SearchedLength searched = searched_length(vehicle.query.poses, vehicle.query.bodies);
  CHECK(searched.whole < searched.path);
  CHECK(vehicle.report.searched == searched);
  CHECK(report.searched == searched);
  CHECK(Result(vehicle.folder / "merged.h5").answer().searched == searched);
  REQUIRE(report.first_place);
  CHECK(*report.first_place == *vehicle.report.first_place);
  CHECK(*report.least_clearance == *vehicle.report.least_clearance);
}

TEST_CASE("a search of a vehicle that was stopped goes on to the same bytes") {
  Vehicle vehicle(80);
  vehicle.query.first_pose = true;
  vehicle.query.clearance = vehicle.query.profile = 0.1;
  vehicle.run();
  const std::string whole = bytes_of(vehicle.folder / "out.h5");
  std::atomic<bool> stop = false;
  SearchOptions options{.threads = 1, .journal_interval_seconds = 0};
  options.progress = [&stop](const ProgressUpdate& update) {
    if (update.stage == "search" && update.done > update.total / 3) stop = true;
  };
  options.stop = &stop;
  const Store store(vehicle.folder / "scan.h5");
  const auto output = vehicle.folder / "resumed.h5";
  CHECK_THROWS_AS(search(store, vehicle.query, output, options), Interrupted);
  Query other = vehicle.query;
  other.bodies[1].name = "another";
  CHECK_THROWS_AS(search(store, other, output, {.threads = 1, .resume = true}), UsageError);
  const SearchReport report = search(store, vehicle.query, output, {.threads = 1, .resume = true});
  CHECK(report.resumed_cells > 0);
  CHECK(bytes_of(output) == whole);
}

TEST_CASE("bodies that contradict path or engine are refused by name") {
  Vehicle vehicle(81);
  const auto refused = [&](const std::string& words, const SearchOptions& options = {}) {
    CHECK_THROWS_WITH(vehicle.run(options), Contains(words));
    vehicle.query = Vehicle(81).query;
  };
  refused("vehicles of several bodies", {.engine = Engine::kKdtree});
  refused("vehicles of several bodies", {.engine = Engine::kGrid});
  vehicle.query.model = {{0, 0, 0}};
  refused("either a model or bodies");
  vehicle.query.bodies[1].name = "front";
  refused("body front: another body");
  vehicle.query.bodies[1].name = "";
  refused("a name of at most");
  vehicle.query.bodies[1].name = "two\nlines";
  refused("in one line");
  vehicle.query.bodies[1].model.vertices.clear();
  refused("body middle has no points");
  vehicle.query.bodies[1].poses.pop_back();
  refused("body middle: has 27 poses");
  vehicle.query.bodies[1].path_pose.back() = 40;
  refused("body middle: its poses are not in the order of the path");
  std::swap(vehicle.query.bodies[1].path_pose[0], vehicle.query.bodies[1].path_pose[1]);
  refused("not in the order");
  vehicle.query.between_poses = true;
  refused("body rear has no pose between poses 1 and 3");
}

TEST_CASE("bodies follow the path of a query") {
  std::vector<Pose> path;
  for (int i = 0; i < 21; ++i) path.push_back(translation({0.5 * i, 0, 0}));
  std::vector<Message> warnings;
  const Body body = follow({.name = "wagon", .model = {{0, 0, 0}}, .poses = {}, .path_pose = {}},
                           path, BodyPivots{2, -1}, &warnings);
  CHECK(body.path_pose.front() == 2);
  CHECK(body.path_pose.back() == 16);
  CHECK(body.poses.size() == 15);
  CHECK(body.poses[0].translation[0] == Approx(1));
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].code == "body-off-path");
  CHECK_THAT(warnings[0].text, Contains("body wagon: 6 of 21 poses"));
  CHECK(follow(body, path, BodyStation{0}).poses == path);
  CHECK_THROWS_AS(follow(body, path, BodyPivots{1, 1}), UsageError);
  CHECK_THROWS_AS(follow(body, path, BodyStation{std::numeric_limits<double>::infinity()}),
                  UsageError);
  CHECK_THROWS_AS(follow(body, path, BodyStation{11}), InputError);
}

TEST_CASE("a body without poses finds nothing, and is warned of") {
  Vehicle vehicle(83);
  vehicle.query.first_pose = true;
  vehicle.query.clearance = vehicle.query.profile = 0.1;
  vehicle.query.bodies[1].poses.clear();
  vehicle.query.bodies[1].path_pose.clear();
  const Result result = vehicle.run();
  const auto source = result.source();
  const auto body = result.first_body();
  CHECK(std::ranges::count(body, 1u) == 0);
  CHECK(std::ranges::count(body, 2u) > 0);
  CHECK(std::ranges::any_of(vehicle.report.warnings, [](const Message& warning) {
    return warning.code == "no-poses" && warning.text.find("body middle") == 0;
  }));
  vehicle.query.bodies.erase(vehicle.query.bodies.begin() + 1);
  CHECK(vehicle.run().source() == source);
}

TEST_CASE("a vehicle's search runs in the memory that its refusal names") {
  Vehicle vehicle(82);
  vehicle.query.first_pose = true;
  vehicle.query.clearance = vehicle.query.profile = 0.1;
  double enough = 0;
  try {
    vehicle.run({.memory_bytes = std::uint64_t{1} << 20});
  } catch (const ResourceError& error) {
    CHECK(error.remedy() == Remedy::kMoreMemory);
    enough = error.amount();
  }
  REQUIRE(enough > 0);
  vehicle.run({.threads = 2, .memory_bytes = std::uint64_t{1} << 32});
  const std::string plenty = bytes_of(vehicle.folder / "out.h5");
  CHECK_NOTHROW(vehicle.run({.memory_bytes = static_cast<std::uint64_t>(enough)}));
  CHECK(bytes_of(vehicle.folder / "out.h5") == plenty);
}
