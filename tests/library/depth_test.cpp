// Depths of whole searches: what is free, in vehicles, with floors and ignored points, and that
// neither threads nor memory nor a stop change a byte.
#include <atomic>
#include <cmath>
#include <fstream>
#include <limits>
#include <vector>

#include "clearway/session.hpp"
#include "core/geometry/predicate.hpp"
#include "library/api_scene.hpp"
#include "library/vehicle_scene.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/result_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

std::vector<bool> colliding(const Result& result, std::size_t points) {
  std::vector<bool> out(points);
  for (const std::uint64_t source : result.source()) out[source] = true;
  return out;
}

/// Compares the depths of a result with the distances to all points that are free.
void check_depths(const Collisions& rows, const std::vector<Vec3>& places,
                  const std::vector<bool>& is_free) {
  REQUIRE(rows.depth.size() == rows.size());
  REQUIRE(rows.depth_source.size() == rows.size());
  std::size_t wrong = 0;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    double least = std::numeric_limits<double>::infinity();
    std::uint64_t source = Collisions::kNoPoint;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double squared = squared_distance(places[i], rows.xyz[row]);
      if (!is_free[i] || !(squared < least)) continue;
      least = squared;
      source = i;
    }
    const bool same = source == Collisions::kNoPoint
                          ? std::isnan(rows.depth[row])
                          : rows.depth[row] == std::sqrt(least);  // not NaN
    wrong += !same || rows.depth_source[row] != source;
  }
  CHECK(wrong == 0);
}

/// The refusal of a search, empty where it succeeds.
template <typename Work>
std::string refusal(const Work& work) {
  try {
    work();
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("depths of vehicles, with floors, ignored points and errors, are those of all points") {
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    CAPTURE(seed);
    Vehicle vehicle(seed, seed % 2 == 0, 12);
    vehicle.query.radius = 0.15;
    if (seed % 2 == 1) vehicle.query.floor = -0.02;
    if (seed % 4 == 1) vehicle.query.bodies[1].floor = 0.01;
    if (seed % 3 == 0) vehicle.query.ignore_boxes = {{{101, -199.5, 0}, {102.5, -198, 0.6}}};
    if (seed % 4 == 3) vehicle.query.error_scan = 0.005;
    vehicle.query.first_pose = seed % 5 == 0;
    if (seed == 5) vehicle.query.radius = 10;  // all collide
    if (seed % 4 == 3) vehicle.make_surface(1);
    vehicle.query.between_poses = seed % 4 == 1;
    Query plain = vehicle.query;
    plain.floor.reset();
    for (Body& body : plain.bodies) body.floor.reset();
    vehicle.query.depth = true;
    const Result result = vehicle.run({.threads = static_cast<int>(1 + seed % 3)});
    const Collisions rows = result.collisions();
    search(Store(vehicle.folder / "scan.h5"), plain, vehicle.folder / "plain.h5");
    std::vector<bool> is_free = colliding(Result(vehicle.folder / "plain.h5"), 2500);
    is_free.flip();
    for (const std::uint64_t source : rows.source) is_free[source] = false;
    const std::vector<Vec3> searched = vehicle.searched_places();
    for (std::size_t i = 0; i < searched.size(); ++i) {
      if (searched[i].x > 1e6) is_free[i] = false;
    }
    CHECK(rows.size() > 0);
    check_depths(rows, vehicle.places, is_free);

    const Answer answer = result.answer();
    REQUIRE(answer.deepest.has_value() == vehicle.report.deepest.has_value());
    CHECK(answer.deepest.has_value() == (seed != 5));
    if (!answer.deepest) continue;
    CHECK(answer.deepest->depth == *std::ranges::max_element(rows.depth));
    CHECK(answer.deepest->depth == vehicle.report.deepest->depth);
    CHECK(answer.deepest->source == vehicle.report.deepest->source);
  }
}

TEST_CASE("neither threads nor memory nor stops change a byte of depths") {
  ApiScene scene;
  scene.query.depth = true;
  scene.query.floor = -0.1;
  const Store store(scene.folder / "wall.h5");
  const auto bytes = [&](const SearchOptions& options) {
    search(store, scene.query, scene.folder / "out.h5", options);
    const std::string out = bytes_of(scene.folder / "out.h5");
    std::filesystem::remove(scene.folder / "out.h5");
    return out;
  };
  const SearchReport report = search(store, scene.query, scene.folder / "whole.h5", {.threads = 1});
  const std::string expected = bytes_of(scene.folder / "whole.h5");
  CHECK(report.colliding_points > 10'000);
  for (const int threads : {2, 5}) check_same(bytes({.threads = threads}), expected);

  // The least memory that is not refused
  std::uint64_t least = 1 << 20;
  for (;;) {
    try {
      check_same(bytes({.device = Device::kCpu, .threads = 2, .memory_bytes = least}), expected);
      break;
    } catch (const ResourceError& error) {
      REQUIRE(error.remedy() == Remedy::kMoreMemory);
      REQUIRE(error.amount() > static_cast<double>(least));
      least = static_cast<std::uint64_t>(error.amount());
      std::filesystem::remove(scene.folder / "out.h5.journal");
    }
  }
  CHECK(least < (std::uint64_t{64} << 20));

  // Where one cell ends by a stop, those that other threads search end unfinished, and are searched
  // again.
  for (std::uint64_t done = 0; done < 16; ++done) {
    CAPTURE(done);
    std::atomic<bool> stop = false;
    SearchOptions options{.device = Device::kCpu, .threads = 4, .stop = &stop};
    options.progress = [&](const ProgressUpdate& update) {
      stop = stop || (update.stage == "depth" && update.done > done * 600);
    };
    CHECK_THROWS_AS(bytes(options), Interrupted);
    stop = false;
    options.progress = nullptr;
    options.resume = true;
    if (done == 0) {
      scene.query.depth = false;
      CHECK_THAT(refusal([&] { bytes(options); }), Contains("depth"));
      scene.query.depth = true;
    }
    check_same(bytes(options), expected);
  }

  Session session(scene.folder / "wall.h5", {.threads = 2});
  const SessionAnswer answer = session.search(scene.query);
  const Collisions rows = Result(scene.folder / "whole.h5").collisions();
  CHECK(answer.collisions().depth == rows.depth);
  CHECK(answer.collisions().depth_source == rows.depth_source);
}

TEST_CASE("a conflict has the greatest depth of its points") {
  Vehicle vehicle(3, false, 12);
  vehicle.query.radius = 0.1;
  vehicle.query.first_pose = vehicle.query.depth = true;
  vehicle.query.error_scan = 0.005;  // so that near points are grouped too
  const Result result = vehicle.run({.threads = 2});
  const Collisions rows = result.collisions();
  std::vector<std::uint32_t> conflict_of;
  ConflictOptions options{.gap = 0.08, .min_points = 2};
  options.bodies = vehicle.query.bodies;
  const Conflicts found = find_conflicts(result, vehicle.query.poses, options, &conflict_of);
  REQUIRE(found.near_points > 0);
  REQUIRE(found.listed.size() > 2);
  for (const Conflict& conflict : found.listed) {
    CAPTURE(conflict.id);
    std::optional<double> greatest;
    std::optional<std::uint64_t> source;
    for (std::size_t row = 0; row < rows.size(); ++row) {
      if (conflict_of[row] != conflict.id || rows.depth[row] <= greatest.value_or(-1)) continue;
      greatest = rows.depth[row];
      source = rows.depth_source[row];
    }
    CHECK(conflict.depth == greatest);
    CHECK(conflict.depth_source == source);
    CHECK_FALSE(conflict.points_inside);
  }
}

TEST_CASE("depths are refused where not all points are known") {
  ApiScene scene;
  scene.query.depth = true;
  const auto search_in = [&](const char* file, const SearchOptions& options) {
    return refusal(
        [&] { search(Store(scene.folder / file), scene.query, scene.folder / "out.h5", options); });
  };
  CHECK_THAT(search_in("wall.h5", {.threads = 1, .shard = Shard{1, 2}}), Contains("shards"));
  std::ofstream(scene.folder / "path.txt") << "1 0 0 0 0 1 0 0 0 0 1 0\n";
  ConvertOptions options{.cell_points = 64, .threads = 2};
  options.near = scene.folder / "path.txt";
  options.within = 3;
  convert({scene.folder / "wall.las"}, scene.folder / "near.h5", options);
  scene.query.poses.resize(1);
  CHECK_THAT(search_in("near.h5", {.threads = 1}), Contains("--near"));
}

TEST_CASE("a result without depths has neither their attribute nor their columns") {
  ApiScene scene;
  search(Store(scene.folder / "wall.h5"), scene.query, scene.folder / "out.h5", {.threads = 2});
  const Result result(scene.folder / "out.h5");
  CHECK_FALSE(result.parameters().depth);
  CHECK(result.collisions().depth.empty());
  CHECK(result.collisions().depth_source.empty());
  CHECK_FALSE(result.answer().deepest);
}
