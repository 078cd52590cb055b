// The built program's answers to the queries beyond the set, and their export.
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "clearway/model.hpp"
#include "clearway/trajectory.hpp"
#include "core/query/search_result.hpp"
#include "support/catch.hpp"
#include "support/engines/brute_force.hpp"
#include "support/result_fixture.hpp"
#include "support/store_fixture.hpp"
#include "tools/cli/support/hall.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr double kClearance = 0.4;

/// The inputs of the small hall, read back.
struct Inputs {
  Inputs() {
    const Hall& hall = Hall::small();
    const StoreReader store(hall.path("site.h5"));
    for (const Quantum& q : points_by_source(store)) {
      environment.push_back(position(store.quantisation(), q[0], q[1], q[2]));
    }
    model = read_model_points(hall.path("model.ply"));
    poses = read_trajectory(hall.path("trajectory.txt"), {});
  }
  Query query() const { return {model, poses, {0.1, true}}; }

  std::vector<Vec3> environment, model;
  std::vector<Pose> poses;
};

Clearances brute_clearances(const Inputs& inputs) {
  const auto all = brute_force_clearances(inputs.environment, inputs.query());
  Clearances rows;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!(all[i].squared < kClearance * kClearance)) continue;
    rows.source.push_back(i);
    rows.distance.push_back(std::sqrt(all[i].squared));
    rows.pose.push_back(all[i].pose);
  }
  return rows;
}

Collisions brute_collisions(const Inputs& inputs, Query query) {
  const auto first = brute_force_first_poses(inputs.environment, query);
  Collisions rows;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (first[i] == kNoPose) continue;
    rows.source.push_back(i);
    rows.xyz.push_back(inputs.environment[i]);
    if (query.first_pose) rows.first_pose.push_back(first[i]);
  }
  return rows;
}

Clearances clearances_of(const std::filesystem::path& path) {
  const ResultReader result(path);
  Clearances rows;
  REQUIRE(result.clearances() <= 65'536);  // one batch
  RowStream<Clearances>(result).read(rows);
  return rows;
}

/// The CSV without its columns x, y and z.
std::string without_places(const std::string& csv) {
  std::string text;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t source = line.find(',');
    std::size_t rest = source;
    for (int k = 0; k < 3; ++k) rest = line.find(',', rest + 1);
    text += line.substr(0, source) + line.substr(rest) + "\n";
  }
  return text;
}

/// The CSV that `export --what clearance` writes, without the places.
std::string csv_of(const Clearances& rows) {
  std::string text = "source,distance,pose\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    char distance[40];
    const auto end = std::to_chars(distance, distance + sizeof distance, rows.distance[i]).ptr;
    text += std::to_string(rows.source[i]) + "," + std::string(distance, end) + "," +
            std::to_string(rows.pose[i]) + "\n";
  }
  return text;
}

}  // namespace

TEST_CASE("clearances are those of brute force, beside the same collisions") {
  const Work work{Hall::small()};
  const Inputs inputs;
  const bool first_pose = GENERATE(false, true);
  const Outcome run = require_success(
      work.run_hall("hall/site.h5", "out.h5",
                    std::string("--clearance 0.4 --json") + (first_pose ? " --first-pose" : "")));
  const Clearances expected = brute_clearances(inputs);
  const Clearances rows = clearances_of(work.folder / "out.h5");
  CHECK(rows.source == expected.source);
  CHECK(rows.distance == expected.distance);
  CHECK(rows.pose == expected.pose);
  Query query = inputs.query();
  query.first_pose = first_pose;
  const Collisions collisions = brute_collisions(inputs, query);
  CHECK(collisions.size() > 100);
  CHECK(expected.size() > collisions.size() + 100);
  CHECK(same_rows(read_rows(ResultReader(work.folder / "out.h5")), collisions));
  CHECK(json_of(run)["clearance_points"] == expected.size());
  check_says(run.err, "points are within the clearance of 0.4 m");
  check_outcome(work.run("verify out.h5"), 0);

  // compare says that only one side has clearances.
  require_success(work.run_hall("hall/site.h5", "set.h5", first_pose ? "--first-pose" : ""));
  check_outcome(work.run("compare out.h5 set.h5"), 0, kAnything, "clearance");
}

TEST_CASE("a profile is that of brute force, beside the same collisions") {
  const Work work{Hall::small()};
  const Inputs inputs;
  require_success(work.run_hall("hall/site.h5", "out.h5", "--profile 0.4"));
  Query query = inputs.query();
  query.profile = 0.4;
  query.first_pose = false;
  const std::vector<NearestPoint> expected = brute_force_profile(inputs.environment, query);
  const ResultReader result(work.folder / "out.h5");
  ProfileRows rows;
  REQUIRE(result.profile_rows() == expected.size());
  REQUIRE(RowStream<ProfileRows>(result).read(rows));
  std::uint64_t wrong = 0, found = 0;
  for (std::size_t pose = 0; pose < expected.size(); ++pose) {
    wrong += rows.distance[pose] != std::sqrt(expected[pose].squared);
    wrong += rows.source[pose] != expected[pose].source;
    if (std::isinf(rows.distance[pose])) continue;
    ++found;
    wrong += rows.xyz[pose] != inputs.environment[rows.source[pose]];
  }
  CHECK(wrong == 0);
  CHECK(found > expected.size() / 2);
  CHECK(same_rows(read_rows(result), brute_collisions(inputs, query)));
  check_outcome(work.run("verify out.h5"), 0);
}

TEST_CASE("clearances below the radius leave the set as it is") {
  const Work work;
  require_success(work.run_hall("hall/site.h5", "out.h5", "--clearance 0.05"));
  require_success(work.run_hall("hall/site.h5", "set.h5"));
  check_outcome(work.run("compare out.h5 set.h5"), 0);
  const ResultReader result(work.folder / "out.h5");
  CHECK(result.clearances() > 0);
  CHECK(result.clearances() < result.collisions());
}

TEST_CASE("export --what chooses the table") {
  const Work work;
  require_success(work.run_hall("hall/site.h5", "out.h5", "--clearance 0.4"));
  const std::string clearances = "export --what clearance out.h5 -o ";
  check_refused(work.run(clearances + "near.csv"), 0, " clearances");
  CHECK(without_places(work.bytes("near.csv")) == csv_of(clearances_of(work.folder / "out.h5")));
  CHECK_THAT(work.bytes("near.csv"), StartsWith("source,x,y,z,distance,pose\n"));
  check_refused(work.run(clearances + "near.csv"), 2, "--force");
  check_outcome(work.run(clearances + "near.csv --force"), 0);
  for (const char* ending : {"las", "ply", "xyz"}) {
    check_outcome(work.run(clearances + std::string("near.") + ending), 0);
  }

  const std::string collisions = "export out.h5 -o ";
  work.succeed(collisions + "a.csv");
  work.succeed(collisions + "b.csv --what collisions");
  check_same(work.bytes("a.csv"), work.bytes("b.csv"));
  CHECK_THAT(work.bytes("a.csv"), StartsWith("source,x,y,z\n"));
  check_refused(work.run(collisions + "c.csv --what distances"), 2, "--what");

  require_success(work.run_hall("hall/site.h5", "set.h5"));
  check_refused(work.run("export --what clearance set.h5 -o none.csv"), 2,
                "makes a result with clearances");
  CHECK_FALSE(work.has("none.csv"));
}

TEST_CASE("an export does not overwrite the result it is of") {
  const Work work;
  require_success(work.run_hall("hall/site.h5", "out.csv", "--clearance 0.4"));
  const std::string result = work.bytes("out.csv");
  for (const std::string what : {"collisions", "clearance"}) {
    check_refused(work.run("export out.csv --force -o out.csv --what " + what), 2, "an input too");
    check_same(work.bytes("out.csv"), result);
  }
}

TEST_CASE("a search between poses finds what brute force finds") {
  const Work work{Hall::small()};
  const std::string site = "hall/site.h5";
  require_success(work.run_hall(site, "sweep.h5", "--between-poses --first-pose"));
  const Inputs inputs;
  Query query = inputs.query();
  const std::size_t at_poses = brute_collisions(inputs, query).size();
  query.between_poses = true;
  const Collisions expected = brute_collisions(inputs, query);
  CHECK(expected.size() > at_poses);
  CHECK(same_rows(read_rows(ResultReader(work.folder / "sweep.h5")), expected));

  require_success(work.run_hall(site, "set.h5", "--first-pose"));
  check_outcome(work.run("compare set.h5 sweep.h5"), 1, kAnything, "between poses");
}

TEST_CASE("queries that no engine or not this engine answers are wrong usage") {
  const Work work;
  const std::string site = "hall/site.h5";
  check_refused(work.run_hall(site, "out.h5", "--clearance 0.4 --between-poses"), 2,
                "clearances and motion between poses cannot be combined");
  for (const std::string engine : {"grid", "kdtree"}) {
    for (const auto& [options, what] : {std::pair{"--between-poses", "motion between poses"},
                                        {"--first-pose", "first poses"},
                                        {"--clearance 0.4", "clearances"},
                                        {"--profile 0.4", "a profile"},
                                        {"--floor 0", "a floor"},
                                        {"--error-scan 0.01", "errors"},
                                        {"--depth", "depths"}}) {
      check_refused(work.run_hall(site, "out.h5", options + (" --engine " + engine)), 2,
                    "engine " + engine +
                        " finds the points that collide at the poses, and nothing "
                        "else: expected engine sweep for " +
                        what + " ... --engine sweep");
    }
  }
  check_refused(work.run_hall(site, "out.h5", "--profile 0.4 --between-poses"), 2,
                "a profile and motion between poses cannot be combined");
  for (const char* value : {"0", "-1", "x", "nan", "inf"}) {
    CAPTURE(value);
    check_refused(work.run_hall(site, "out.h5", std::string("--clearance ") + value), 2,
                  "--clearance");
    check_refused(work.run_hall(site, "out.h5", std::string("--profile ") + value), 2, "--profile");
  }
  CHECK_FALSE(work.has("out.h5"));
  CHECK_FALSE(work.has("out.h5.partial"));
}
