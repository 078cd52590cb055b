// Vehicles of several bodies: what is refused, how bodies follow a path, and what results say.
#include <cmath>
#include <limits>

#include "clearway/conflicts.hpp"
#include "clearway/error.hpp"
#include "io/result/result.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/questions.hpp"

using namespace clearway;
using namespace clearway::test;

TEST_CASE("bodies that contradict path, engine or their own triangles are refused by name") {
  const AskedScan scan(41, true);
  const Query sound = scan.vehicle(81);
  Query query = sound;
  const auto refused = [&](const char* words, Engine engine = Engine::kSweep) {
    check_refused([&] { searched(scan, query, "out.h5", {.engine = engine}); }, words);
    query = sound;
  };
  refused("vehicles of several bodies", Engine::kKdtree);
  refused("vehicles of several bodies", Engine::kGrid);
  query.model = {{0, 0, 0}};
  refused("either a model or bodies");
  query.bodies[1].name = "front";
  refused("body front: another body");
  query.bodies[1].name = "";
  refused("a name of at most");
  query.bodies[1].name = "two\nlines";
  refused("in one line");
  query.bodies[1].model.vertices.clear();
  refused("body middle has no points");
  query.bodies[1].poses.pop_back();
  refused("body middle: has 27 poses");
  query.bodies[1].path_pose.back() = 40;
  refused("body middle: its poses are not in the order of the path");
  std::swap(query.bodies[1].path_pose[0], query.bodies[1].path_pose[1]);
  refused("not in the order");
  query.between_poses = true;
  refused("body rear has no pose between poses 1 and 3");
  query.bodies.pop_back();
  query.bodies[1].model.triangles = {{0, 1, 2}};
  query.between_poses = true;
  refused("motion between poses is searched for models of points");
  query.bodies[2].model.triangles = {{0, 1, 25}};
  refused("of body rear has the corner 25");
  query.bodies[2].model = Model(query.bodies[2].model.vertices, {{0, 1, 2}}, {0, 0});
  refused("body rear has ... the solids of");
  query.bodies[2].model = Model(query.bodies[2].model.vertices, {{0, 1, 2}}, {1000});
  refused("body rear names solid 1000");
  query.floor = 0;
  double* const r = query.bodies[1].poses[3].rotation;
  r[2] = r[5] = r[8] = 0;
  refused("body middle: the rotation of pose 3 has no inverse");
  query.floor = std::nan("");
  refused("the floor is nan, expected a finite number");
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

TEST_CASE("a vehicle's result says what its bodies consist of, and a body without poses is named") {
  const AskedScan scan(41, true);
  Query query = scan.vehicle(83);
  const auto header_of = [&](const Model& model) {
    query.bodies[0].model = query.bodies[2].model = model;
    const SearchReport report =
        search(Store(scan.store), query, scan.folder / "out.h5", {.threads = 1, .overwrite = true});
    const ResultHeader header = Result(scan.folder / "out.h5").reader().header();
    CHECK(report.model_triangles == header.model_triangles);
    REQUIRE(report.searched);
    CHECK(report.searched->whole < report.searched->path);
    return header;
  };
  Model solids = scan.models[4];
  const ResultHeader with_solids = header_of(solids);
  CHECK(with_solids.model_solids == 4);
  CHECK(with_solids.model_triangles == 2 * solids.triangles.size());
  solids.solid_of.clear();
  const ResultHeader with_triangles = header_of(solids);
  CHECK(with_triangles.model_solids == 0);
  CHECK(with_triangles.model_hash != with_solids.model_hash);
  solids.triangles.clear();
  const ResultHeader with_points = header_of(solids);
  CHECK(with_points.model_triangles == 0);
  CHECK(with_points.model_hash != with_triangles.model_hash);

  query.bodies[1].poses.clear();
  query.bodies[1].path_pose.clear();
  const SearchReport report =
      search(Store(scan.store), query, scan.folder / "none.h5", {.threads = 1});
  CHECK(std::ranges::any_of(report.warnings, [](const Message& warning) {
    return warning.code == "no-poses" && warning.text.starts_with("body middle");
  }));
}

TEST_CASE("a conflict has the greatest depth of its points") {
  const AskedScan scan(41, true);
  Query query = scan.vehicle(3, 12, false);
  query.radius = 0.1;
  query.first_pose = query.depth = true;
  query.error_scan = 0.005;  // so that near points are grouped too
  searched(scan, query, "out.h5");
  const Result result(scan.folder / "out.h5");
  const Collisions rows = result.collisions();
  std::vector<std::uint32_t> conflict_of;
  ConflictOptions options{.gap = 0.08, .min_points = 2};
  options.bodies = query.bodies;
  const Conflicts found = find_conflicts(result, query.poses, options, &conflict_of);
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
