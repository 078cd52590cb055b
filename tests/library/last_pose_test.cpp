// The last pose that touches each point, against brute force, which asks every pose or way alone.
#include "library/vehicle_truth.hpp"
#include "support/catch.hpp"
#include "support/solid_scene.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// The query of one body, or of the model, at its pose i alone, or on the way from there to the
/// next.
Query alone(const Query& whole, std::size_t i) {
  Query one = whole;
  const std::size_t end = whole.between_poses ? std::min(i + 2, whole.poses.size()) : i + 1;
  one.poses.assign(whole.poses.begin() + static_cast<std::ptrdiff_t>(i),
                   whole.poses.begin() + static_cast<std::ptrdiff_t>(end));
  return one;
}

/// The last pose of the path that touches each place, by brute force; kNever where none does.
std::vector<std::uint32_t> last_by_hand(const std::vector<Vec3>& places, const Query& query,
                                        const std::vector<std::uint32_t>& path_pose) {
  std::vector<std::uint32_t> out(places.size(), kNever);
  const std::size_t ways =
      query.between_poses && query.poses.size() > 1 ? query.poses.size() - 1 : query.poses.size();
  for (std::size_t i = 0; i < ways; ++i) {
    const auto touched = brute_force_first_poses(places, alone(query, i));
    for (std::size_t e = 0; e < places.size(); ++e) {
      if (touched[e] != kNever)
        out[e] = path_pose.empty() ? static_cast<std::uint32_t>(i) : path_pose[i];
    }
  }
  return out;
}

void check_last_poses(const Result& result, const std::vector<std::uint32_t>& expected) {
  const auto source = result.source();
  const auto first = result.first_pose(), last = result.last_pose();
  REQUIRE(last.size() == source.size());
  REQUIRE(source.size() > 20);
  std::size_t later = 0;
  for (std::size_t row = 0; row < source.size(); ++row) {
    CHECK(last[row] == expected[source[row]]);
    CHECK(last[row] >= first[row]);
    later += last[row] > first[row] ? 1 : 0;
  }
  CHECK(later > 0);
}

/// The query of the first body's model alone, on the vehicle's path.
Query one_model(const Vehicle& vehicle, bool between_poses) {
  Query query(vehicle.query.bodies[0].model, vehicle.query.poses, vehicle.query);
  query.first_pose = true;
  query.between_poses = between_poses;
  if (vehicle.query.bodies[0].floor) query.floor = vehicle.query.bodies[0].floor;
  return query;
}

Result search_of(const Vehicle& vehicle, const Query& query, const SearchOptions& options) {
  SearchOptions how = options;
  how.overwrite = true;
  how.device = Device::kCpu;
  search(Store(vehicle.folder / "scan.h5"), query, vehicle.folder / "last.h5", how);
  return Result(vehicle.folder / "last.h5");
}

}  // namespace

TEST_CASE("the last pose that touches each point is found") {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    Vehicle vehicle(seed);
    if (seed > 3) vehicle.query.bodies[0].floor = -0.05;
    const Query query = one_model(vehicle, false);
    const auto expected = last_by_hand(vehicle.places, query, {});
    CAPTURE(seed);
    check_last_poses(search_of(vehicle, query, {.threads = 2}), expected);
  }
}

TEST_CASE("between poses the last pose is the start of the last way that touches") {
  for (const std::uint64_t seed : {4, 5, 6, 7}) {
    Vehicle vehicle(seed);
    if (seed > 5) vehicle.query.bodies[0].floor = -0.05;
    const Query query = one_model(vehicle, true);
    const auto expected = last_by_hand(vehicle.places, query, {});
    CAPTURE(seed);
    check_last_poses(search_of(vehicle, query, {.threads = 2}), expected);
  }
}

TEST_CASE("last poses of surfaces and solids, and without ignored points") {
  Vehicle vehicle(6);
  vehicle.make_surface(0);
  const Query query = one_model(vehicle, false);
  check_last_poses(search_of(vehicle, query, {.threads = 2}),
                   last_by_hand(vehicle.places, query, {}));
  Bodies solid;
  solid.add(box_surface({{-0.3, -0.2, -0.1}, {0.3, 0.2, 0.1}}));
  Query inside = solid.query(vehicle.query.poses, 0.02);
  inside.first_pose = true;
  check_last_poses(search_of(vehicle, inside, {.threads = 2}),
                   last_by_hand(vehicle.places, inside, {}));
  vehicle.query.ignore_boxes = {{{100, -200, 0}, {102, -197, 1}}};
  Query ignoring = one_model(vehicle, false);
  check_last_poses(search_of(vehicle, ignoring, {.threads = 2}),
                   last_by_hand(vehicle.searched_places(), ignoring, {}));
}

TEST_CASE("last poses of a vehicle's bodies are of the path, at poses and between them") {
  for (const bool between : {false, true}) {
    Vehicle vehicle(7, !between);
    vehicle.query.first_pose = true;
    vehicle.query.between_poses = between;
    vehicle.query.bodies[1].floor = -0.05;
    std::vector<std::uint32_t> expected(vehicle.places.size(), kNever);
    for (std::size_t body = 0; body < vehicle.query.bodies.size(); ++body) {
      const auto own =
          last_by_hand(vehicle.places, vehicle.of(body), vehicle.query.bodies[body].path_pose);
      for (std::size_t e = 0; e < own.size(); ++e) {
        if (own[e] != kNever)
          expected[e] = expected[e] == kNever ? own[e] : std::max(expected[e], own[e]);
      }
    }
    check_last_poses(search_of(vehicle, vehicle.query, {.threads = 2}), expected);
  }
}

TEST_CASE("last poses of merged parts are those of the whole, byte for byte") {
  const Vehicle vehicle(8);
  const Query query = one_model(vehicle, false);
  search_of(vehicle, query, {.threads = 2});
  std::vector<std::filesystem::path> parts;
  for (std::uint32_t i = 1; i <= 3; ++i) {
    parts.push_back(vehicle.folder / ("part" + std::to_string(i) + ".h5"));
    search(Store(vehicle.folder / "scan.h5"), query, parts.back(),
           {.device = Device::kCpu, .threads = 2, .shard = Shard{i, 3}});
  }
  merge(parts, vehicle.folder / "merged.h5", {});
  CHECK(bytes_of(vehicle.folder / "merged.h5") == bytes_of(vehicle.folder / "last.h5"));
}

TEST_CASE("a result without first poses has no last poses") {
  const Vehicle vehicle(9);
  Query query = one_model(vehicle, false);
  query.first_pose = false;
  CHECK(search_of(vehicle, query, {.threads = 2}).last_pose().empty());
}
