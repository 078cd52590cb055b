// The built program's answers to the queries beyond the set are those of brute force.
#include <cmath>
#include <nlohmann/json.hpp>

#include "clearway/model.hpp"
#include "clearway/trajectory.hpp"
#include "core/query/search_result.hpp"
#include "support/catch.hpp"
#include "support/engines/brute_force.hpp"
#include "support/store_fixture.hpp"
#include "tools/cli/support/hall.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// The small hall, and its inputs, read back.
struct Site : Work {
  Site() : Work(Hall::small()) {
    const StoreReader store(hall.path("site.h5"));
    for (const Quantum& q : points_by_source(store)) {
      environment.push_back(position(store.quantisation(), q[0], q[1], q[2]));
    }
    query = {read_model_points(hall.path("model.ply")),
             read_trajectory(hall.path("trajectory.txt"), {}),
             {0.1, true}};
  }
  Outcome search(const std::string& options, const std::string& output = "out.h5") const {
    return require_success(run_hall("hall/site.h5", output, options));
  }
  ResultReader result() const { return ResultReader(folder / "out.h5"); }

  Collisions collisions() const {
    const auto first = brute_force_first_poses(environment, query);
    Collisions rows;
    for (std::size_t i = 0; i < first.size(); ++i) {
      if (first[i] == kNoPose) continue;
      rows.source.push_back(i);
      rows.xyz.push_back(environment[i]);
      if (query.first_pose) rows.first_pose.push_back(first[i]);
    }
    return rows;
  }

  std::vector<Vec3> environment;
  Query query;
};

}  // namespace

TEST_CASE("clearances are those of brute force, beside the same collisions") {
  Site site;
  const auto all = brute_force_clearances(site.environment, site.query);
  site.query.first_pose = GENERATE(false, true);
  const std::string first = site.query.first_pose ? " --first-pose" : "";
  const Outcome run = site.search("--clearance 0.4 --json" + first);
  Clearances expected;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!(all[i].squared < 0.4 * 0.4)) continue;
    expected.source.push_back(i);
    expected.distance.push_back(std::sqrt(all[i].squared));
    expected.pose.push_back(all[i].pose);
  }
  const auto rows = read_rows<Clearances>(site.result());
  CHECK(rows.source == expected.source);
  CHECK(rows.distance == expected.distance);
  CHECK(rows.pose == expected.pose);
  const Collisions collisions = site.collisions();
  CHECK(collisions.size() > 100);
  CHECK(expected.size() > collisions.size() + 100);
  CHECK(same_rows(read_rows(site.result()), collisions));
  CHECK(json_of(run)["clearance_points"] == expected.size());
  check_says(run.err, "points are within the clearance of 0.4 m");
  // A run without clearances, and one with those below the radius, have the same set.
  site.search(first, "set.h5");
  check_outcome(site.run("compare out.h5 set.h5"), 0, kAnything, "clearance");
  site.search("--clearance 0.05 --force");
  check_outcome(site.run("compare out.h5 set.h5"), 0);
  CHECK(site.result().clearances() > 0);
  CHECK(site.result().clearances() < site.result().collisions());
}

TEST_CASE("a profile is that of brute force, beside the same collisions") {
  Site site;
  site.search("--profile 0.4");
  site.query.profile = 0.4;
  site.query.first_pose = false;
  const std::vector<NearestPoint> expected = brute_force_profile(site.environment, site.query);
  const auto rows = read_rows<ProfileRows>(site.result());
  REQUIRE(rows.distance.size() == expected.size());
  std::uint64_t wrong = 0, found = 0;
  for (std::size_t pose = 0; pose < expected.size(); ++pose) {
    wrong += rows.distance[pose] != std::sqrt(expected[pose].squared);
    wrong += rows.source[pose] != expected[pose].source;
    if (std::isinf(rows.distance[pose])) continue;
    ++found;
    wrong += rows.xyz[pose] != site.environment[rows.source[pose]];
  }
  CHECK(wrong == 0);
  CHECK(found > expected.size() / 2);
  CHECK(same_rows(read_rows(site.result()), site.collisions()));
}

TEST_CASE("a search between poses finds what brute force finds") {
  Site site;
  site.search("--between-poses --first-pose");
  const std::size_t at_poses = site.collisions().size();
  site.query.between_poses = true;
  const Collisions expected = site.collisions();
  CHECK(expected.size() > at_poses);
  CHECK(same_rows(read_rows(site.result()), expected));
  site.search("--first-pose", "set.h5");
  check_outcome(site.run("compare set.h5 out.h5"), 1, kAnything, "between poses");
}
