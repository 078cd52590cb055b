// Vehicles of several bodies against brute force, body by body, merged by hand.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "clearway/clearway.hpp"
#include "core/geometry/predicate.hpp"
#include "core/geometry/quantisation.hpp"
#include "core/query/hit_set.hpp"
#include "cpu/brute_force.hpp"
#include "support/scenes.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

namespace {

constexpr std::uint32_t kNever = HitSet::kNever;

/// Random points in a box, and three bodies on a path through it. The second body lacks the first
/// and the last poses, the third has some here and there; points and models of two bodies coincide
/// at some poses, so that bodies tie.
struct Vehicle {
  explicit Vehicle(std::uint64_t seed, bool gaps = true, std::size_t poses = 40) {
    Random random(seed);
    for (int i = 0; i < 2500; ++i) {
      points.push_back({static_cast<std::int32_t>(below(random, 4000)),
                        static_cast<std::int32_t>(below(random, 3000)),
                        static_cast<std::int32_t>(below(random, 1000))});
    }
    write_las(folder / "scan.las", points);
    convert({folder / "scan.las"}, folder / "scan.h5", {.cell_points = 64, .threads = 2});
    for (const Quantum& q : points) {
      places.push_back(position(kMillimetres, q[0], q[1], q[2]));
    }
    const Box room{{100, -200, 0}, {104, -197, 1}};
    query.poses = smooth_path(random, room, poses);
    const Box part{{-0.3, -0.2, -0.1}, {0.3, 0.2, 0.1}};
    for (const char* name : {"front", "middle", "rear"}) {
      Body body{
          .name = name, .model = random_points(random, part, 25), .poses = {}, .path_pose = {}};
      query.bodies.push_back(body);
    }
    query.bodies[2].model = query.bodies[0].model;
    const auto count = static_cast<std::uint32_t>(poses);
    for (std::uint32_t i = 0; i < count; ++i) {
      add(0, i, query.poses[i]);
      if (i >= 5 && i + 7 < count) {
        Pose moved = query.poses[i];
        moved.translation[0] += 0.4;
        add(1, i, moved);
      }
      Pose other = query.poses[i];
      if (i % 3 != 0) other.translation[1] -= 0.3;
      if (gaps ? i % 5 != 2 : i < 30) add(2, i, other);
    }
    query.radius = 0.06;
  }

  void add(std::size_t body, std::uint32_t pose, const Pose& at) {
    query.bodies[body].poses.push_back(at);
    query.bodies[body].path_pose.push_back(pose);
  }
  Query of(std::size_t body) const {
    return {query.bodies[body].model, query.bodies[body].poses, query};
  }

  Result run(const SearchOptions& options = {}) {
    SearchOptions how = options;
    how.threads = std::max(how.threads, 1);
    how.overwrite = true;
    report = search(Store(folder / "scan.h5"), query, folder / "out.h5", how);
    return Result(folder / "out.h5");
  }

  ScratchFolder folder;
  std::vector<Quantum> points;
  std::vector<Vec3> places;
  Query query;
  SearchReport report;
};

/// A pose of the path and a body; none: kNever.
struct First {
  std::uint32_t pose = kNever, body = kNever;
  friend auto operator<=>(const First&, const First&) = default;
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
  refused("searches one model", {.engine = Engine::kKdtree});
  refused("searches one model", {.engine = Engine::kGrid});
  refused("on the CPU alone", {.device = Device::kCuda});
  vehicle.query.tolerance = 0.01;
  refused("tolerance");
  vehicle.query.model = {{0, 0, 0}};
  refused("either a model or bodies");
  vehicle.query.bodies[1].name = "front";
  refused("body front: another body");
  vehicle.query.bodies[1].name = "";
  refused("a name of at most");
  vehicle.query.bodies[1].name = "two\nlines";
  refused("in one line");
  vehicle.query.bodies[1].model.clear();
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
