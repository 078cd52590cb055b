// The station table, against brute force over a result's clearances and over the query itself.
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "clearway/clearway.hpp"
#include "core/trajectory/paths.hpp"
#include "findings/conflict_fixture.hpp"
#include "findings/searched_scene.hpp"
#include "findings/station_oracle.hpp"
#include "io/result/answer.hpp"
#include "io/result/conflicts/station_file.hpp"
#include "support/compare.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

struct StationScene : SearchedScene {
  using SearchedScene::SearchedScene;

  StationTable table(double every, StationOptions options = {}) const {
    options.every = every;
    options.bodies = query.bodies;
    options.threads = 2;
    return station_table(result(), query.poses, options);
  }
};

/// Whether any point collides at a pose of the row, by trying all; or on a way that meets the row.
std::vector<bool> touched_rows(const StationScene& scene, double every) {
  const std::vector<std::size_t> row_of = rows_of(scene.query.poses, every);
  std::vector<bool> out(row_of.back() + 1);
  for (const MovingBody& body : moving_bodies(scene.query)) {
    for (std::size_t k = 0; k < body.poses.size(); ++k) {
      const std::size_t at = body.path_pose.empty() ? k : body.path_pose[k];
      const bool ways = scene.query.between_poses;
      if (ways && k + 1 == body.poses.size()) break;
      Query one(Model{body.model}, {body.poses[k]}, scene.query);
      if (ways) one.poses.push_back(body.poses[k + 1]);
      if (!collide(scene.points, one)) continue;
      for (std::size_t row = row_of[at]; row <= row_of[at + (ways ? 1 : 0)]; ++row) out[row] = true;
    }
  }
  return out;
}

/// Whether some colliding point has its first pose on the row or before, and its last one on it or
/// behind.
std::vector<bool> rows_between(const StationScene& scene, double every) {
  const std::vector<std::size_t> row_of = rows_of(scene.query.poses, every);
  std::vector<bool> out(row_of.back() + 1);
  const auto first = scene.result().first_pose(), last = scene.result().last_pose();
  const std::size_t way = scene.query.between_poses ? 1 : 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    for (std::size_t row = row_of[first[i]]; row <= row_of[last[i] + way]; ++row) out[row] = true;
  }
  return out;
}

Verdict worst_of(const StationTable& table) {
  Verdict worst = Verdict::kClear;
  for (const StationRow& row : table.rows) {
    if (row.verdict == Verdict::kConflict) return Verdict::kConflict;
    if (row.verdict == Verdict::kUndecided) worst = Verdict::kUndecided;
  }
  return worst;
}

void check_scene(const StationScene& scene, double every) {
  CAPTURE(every);
  const StationTable table = scene.table(every);
  check_distances(table, expected_rows(scene.result(), scene.query, every), scene.query.radius);
  const std::vector<bool> touched = touched_rows(scene, every),
                          between = rows_between(scene, every);
  REQUIRE(table.rows.size() == touched.size());
  for (std::size_t i = 0; i < touched.size(); ++i) {
    CAPTURE(i);
    if (touched[i]) CHECK(table.rows[i].verdict == Verdict::kConflict);
    if (!between[i]) CHECK(table.rows[i].verdict != Verdict::kConflict);
    if (scene.query.profile > 0) {
      CHECK((table.rows[i].verdict == Verdict::kConflict) == touched[i]);
      if (table.rows[i].verdict == Verdict::kClear && table.rows[i].is_searched) {
        CHECK(table.rows[i].least_above.has_value() != table.rows[i].least.has_value());
      }
    }
  }
  const bool any = scene.result().size() > 0;
  CHECK((worst_of(table) == Verdict::kConflict) == any);
}

const std::vector<Vec3> kCar{{-1, -0.5, 0}, {-1, 0.5, 0}, {1, -0.5, 0}, {1, 0.5, 0}, {0, 0, 1}};

}  // namespace

TEST_CASE("rows of random scenes have the distances of all clearances, and every contact") {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const Box room{{0, -3, 0}, {12, 3, 2}};
    std::vector<Vec3> model = random_points(random, {{-0.6, -0.4, 0}, {0.6, 0.4, 0.8}}, 40);
    QueryParameters asked{.radius = 0.12, .clearance = 0.5};
    if (seed % 3 == 0) asked = {.radius = 0.12, .between_poses = true};
    if (seed % 4 == 1) asked = {.radius = 0.12, .clearance = 0.2, .profile = 0.4};
    if (seed % 4 == 2) asked = {.radius = 0.12, .profile = 0.4};
    Query query(std::move(model), smooth_path(random, room, 50), asked);
    const StationScene scene(random_points(random, room, seed % 2 == 0 ? 60 : 600), query);
    for (const double every : {0.3, 1.0, 2.7, 100.0}) check_scene(scene, every);
  }
}

TEST_CASE("rows of a vehicle are seen from its bodies, and are not clear where one has no pose") {
  std::size_t clear = 0, missing = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const Box room{{0, -3, 0}, {20, 3, 2}};
    const std::vector<Pose> path = circle_poses(1 / 25.0, 0.25, 81);
    Query query({}, path, {.radius = 0.1, .clearance = 0.6});
    const std::vector<Vec3> front = random_points(random, {{-0.6, -0.4, 0}, {0.6, 0.4, 0.8}}, 30);
    const std::vector<Vec3> rear = random_points(random, {{-1.6, -0.5, 0}, {0.6, 0.5, 0.9}}, 30);
    query.bodies.push_back(follow({"front", Model{front}, {}, {}}, path, BodyStation{1}));
    query.bodies.push_back(follow({"rear", Model{rear}, {}, {}}, path, BodyPivots{-1, -3}));
    const StationScene scene(random_points(random, room, 25), query);
    for (const double every : {0.7, 2.0}) check_scene(scene, every);
    const StationTable table = scene.table(1);
    check_equal(table.bodies, {"front", "rear"});
    for (const StationRow& row : table.rows) {
      // The rear has poses from chainage 3 on, the front up to 1 m before the end.
      const bool searched =
          row.chainage_from >= 3.1 && row.chainage_to <= chainages(path).back() - 1.3;
      if (searched) CHECK(row.is_searched);
      if (row.chainage_from < 2.9) CHECK_FALSE(row.is_searched);
      if (!row.is_searched) CHECK(row.verdict != Verdict::kClear);
      clear += row.verdict == Verdict::kClear ? 1 : 0;
      missing += row.is_searched ? 0 : 1;
    }
    const StationTable blind = station_table(scene.result(), path, {.every = 1});
    for (const StationRow& row : blind.rows) {
      CHECK(row.verdict != Verdict::kClear);
      CHECK_FALSE(row.left);
      CHECK_FALSE(row.overthrow.at(1).end);
    }
    check_equal(codes_of(blind.warnings), "sides-unknown, searched-unknown");
  }
  CHECK(clear > 20);
  CHECK(missing > 20);
}

TEST_CASE("a pose on a border belongs to the later row, and the last pose to the last row") {
  const auto table = [](const Vec3& point, const std::vector<Pose>& path, double every) {
    return StationScene({point}, Query(kCar, path, {.radius = 0.1, .clearance = 9})).table(every);
  };
  for (const double x : {2.0, 1.9, 10.0, 8.0, 7.9}) {
    CAPTURE(x);
    // The point above is nearest where the model's top stands below it.
    const std::vector<StationRow> rows = table({x, 0, 1.5}, straight_path(10), 2).rows;
    REQUIRE(rows.size() == 5);
    const auto own = static_cast<std::size_t>(std::min(4.0, std::floor(std::round(2 * x) / 4)));
    for (std::size_t i = 0; i < rows.size(); ++i) CHECK(rows[i].least.has_value() == (i == own));
    CHECK(rows[own].above);
    CHECK_FALSE(rows[own].left);
  }
  const std::pair<double, std::size_t> counts[] = {{2.5, 4}, {3, 4}, {10, 1}, {1e300, 1}};
  for (const auto& [every, rows] : counts) {
    const StationTable found = table({50, 50, 0}, straight_path(10), every);
    REQUIRE(found.rows.size() == rows);
    check_equal(found.rows[0].chainage_from, 0);
    check_equal(found.rows.back().chainage_from, every * static_cast<double>(rows - 1));
    check_equal(found.rows.back().chainage_to, 10);
  }
  // Sums of steps make no row of their own: this path is 9.99999999999998 m long.
  const std::vector<Pose> path = straight_path(10, 0.1);
  check_equal(table({50, 50, 0}, path, chainages(path).back() / 2 * (1 - 1e-12)).rows.size(), 2);
  check_equal(table({50, 50, 0}, path, 5).rows.size(), 2);
}

TEST_CASE("chainages begin where asked, and stations lie between those of the poses") {
  const std::vector<Pose> path = straight_path(10);
  const StationScene scene({{4, 0.7, 0}}, Query(kCar, path, {.radius = 0.1, .clearance = 1}));
  std::vector<double> station;
  for (const double chainage : chainages(path)) station.push_back(1000 - 2 * chainage);
  StationOptions options{.chainage_start = 130.25, .station = station};
  const StationTable table = scene.table(3, options);
  REQUIRE(table.rows.size() == 4);
  check_equal(table.rows[1].chainage_from, 133.25);
  check_equal(table.rows[3].chainage_to, 140.25);
  check_equal(table.rows[1].station_from, 994.0);
  check_equal(table.rows[3].station_to, 980.0);
  CHECK(table.rows[1].left.has_value());  // at 3 m, where a corner is beside the point
  CHECK(scene.table(0.7, options).rows[1].station_from.value() == Approx(998.6));
  options.station = options.station.first(3);
  check_refused([&] { return scene.table(3, options); }, "3 stations for 21 poses");
}

TEST_CASE("lengths of stretches that make no sense are refused") {
  const StationScene scene({{4, 0.7, 0}}, Query(kCar, straight_path(10), {.radius = 0.1}));
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double every : {0.0, -1.0, std::nan(""), infinite, 1e-5, 1e-300}) {
    CAPTURE(every);
    CHECK_THROWS_AS(scene.table(every), UsageError);
  }
  check_refused([&] { return scene.table(1e-5); }, "more than 100,000; expected at least 0.0001 m");
  check_equal(scene.table(1e-4).rows.size(), 100'000);
}

TEST_CASE("a row is in conflict where its poses touch, and clear where all of it was searched") {
  std::vector<Pose> and_back = straight_path(40);  // aside, and past where it began
  for (int i = 1; i <= 80; ++i) and_back.push_back(translation({40 - 0.5 * i, 0.3, 0}));
  const std::vector<Pose> path = straight_path(10), coarse = straight_path(10, 2.5);
  struct Row {
    const char* what;
    Vec3 point;
    std::vector<Pose> path;
    QueryParameters asked;
    double every;
    const char* verdicts;  ///< "!" conflict, "." clear, "?" undecided, "-" not searched
  };
  for (const Row& row :
       {Row{"a post", {4, 0.55, 0}, path, {.radius = 0.1}, 2, ".!!.."},
        Row{"one pose", {1, 0.55, 0}, straight_path(0), {.radius = 0.1, .clearance = 1}, 5, "!"},
        Row{"no pose", {1, 0.55, 0}, {}, {.radius = 0.1}, 5, ""},
        Row{"a few poses", {50, 50, 0}, coarse, {.radius = 0.1}, 1, "?-?--?-?-?"},
        Row{"ways between them",
            {50, 50, 0},
            coarse,
            {.radius = 0.1, .between_poses = true},
            1,
            "??????????"},
        Row{"a question in doubt", {5000, 50, 0}, path, {.radius = 0.1}, 2, "?????"},
        Row{"back again", {1, 0.55, 0}, and_back, {.radius = 0.3}, 5, "!.????????????.!!"}}) {
    const RowName name(row.what);
    const StationTable table =
        StationScene({row.point}, Query(kCar, row.path, row.asked)).table(row.every);
    std::string verdicts;
    for (const StationRow& one : table.rows) {
      verdicts += one.verdict == Verdict::kConflict ? "!"
                  : !one.is_searched                ? "-"
                  : one.verdict == Verdict::kClear  ? "."
                                                    : "?";
      CHECK((one.least || one.left || one.above) == (row.asked.clearance > 0));
      if (row.point.x == 5000) CHECK(one.reasons == std::vector{Reason::kQuestionInDoubt});
      if (table.rows.size() == 1) CHECK_FALSE(one.overthrow.at(0).end);
    }
    check_equal(verdicts, row.verdicts);
    if (row.asked.clearance == 0 && !row.path.empty()) {
      check_equal(codes_of(table.warnings), "no-clearances");
    }
  }
}

namespace {

/// The overthrow of one body on each row of a table of a path without any conflict.
std::vector<Overthrow> overthrows(const std::vector<Pose>& path, const Body& body,
                                  StationOptions options = {}) {
  const Found found{.poses = path, .bodies = {body}};
  const ScratchFolder folder;
  options.bodies = found.bodies;
  std::vector<Overthrow> out;
  for (const StationRow& row : station_table(found.write(folder), path, options).rows) {
    out.push_back(row.overthrow.at(0));
  }
  return out;
}

}  // namespace

TEST_CASE("the overthrow on a circle is that of the closed form, in reverse and with y ahead too") {
  const double apart = 19, length = 26.4, step = 0.2;
  for (const double radius : {40.0, -40.0, 150.0, -800.0}) {
    CAPTURE(radius);
    const double across = std::abs(radius);
    const double inner = std::sqrt(across * across - apart * apart / 4);
    const double end = std::sqrt(inner * inner + length * length / 4) - across;
    const double half_way = across * std::asin(apart / 2 / across);  // along the path to a pivot
    const std::vector<Pose> path = circle_poses(1 / radius, step, 600);
    const Model line{{{-length / 2, 0, 0}, {length / 2, 0, 0}}};
    const Body whole = follow({"wagon", line, {}, {}}, path, BodyPivots{half_way, -half_way});
    // Rows at the ends see an end of the body beyond the path's, so only the inner poses are taken.
    Body body{"wagon", line, {}, {}};
    for (std::size_t k = 30; k + 30 < whole.poses.size(); ++k) {
      body.poses.push_back(whole.poses[k]);
      body.path_pose.push_back(whole.path_pose[k]);
    }
    const auto check = [&](const std::vector<Pose>& on, const Body& one,
                           const StationOptions& options = {}) {
      std::size_t rows = 0;
      for (const Overthrow& row : overthrows(on, one, options)) {
        if (!row.end || !row.middle) continue;
        check_near(*row.end, end, 1e-6);
        check_near(*row.middle, across - inner, 1e-6);
        ++rows;
      }
      CHECK(rows > 10);
    };
    check(path, body);
    Body sideways{"wagon", Model{{{0, -length / 2, 0}, {0, length / 2, 0}}}, {}, body.path_pose};
    for (const Pose& pose : body.poses) {
      sideways.poses.push_back(times(pose, rotation({0, 0, 1}, -std::numbers::pi / 2, {})));
    }
    check(path, sideways, {.forward = Axis::kPlusY});
    std::ranges::reverse(body.poses);
    std::ranges::reverse(body.path_pose);
    for (std::uint32_t& pose : body.path_pose) {
      pose = static_cast<std::uint32_t>(path.size()) - 1 - pose;
    }
    check({path.rbegin(), path.rend()}, body);
  }
}

TEST_CASE("on a straight path the overthrow is the distance to either side") {
  const std::vector<Pose> path = straight_path(30);
  Body body{"trolley", Model{{{-2, -1, 0}, {2, 1, 1}}}, {}, {}};
  for (std::uint32_t i = 0; i < path.size(); ++i) {
    body.poses.push_back(translation({0.5 * i, -0.25, 0.1}));
    body.path_pose.push_back(i);
  }
  for (const Overthrow& row : overthrows(path, body)) {
    CHECK(row.end.value() == Approx(0.25));
    CHECK(row.middle.value() == Approx(0.25));
  }
}

namespace {

/// A query with an error budget that keeps 0.1 m + U free, where U is about 0.06 m on either side.
QueryParameters with_budget() {
  return {.radius = 0.1, .clearance = 0.5, .error_registration = 0.02, .sigmas = 3};
}

std::vector<Vec3> post(double x, double y, std::size_t points) {
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < points; ++i) out.push_back({x, y, 0.002 * static_cast<double>(i)});
  return out;
}

}  // namespace

TEST_CASE("with an error budget certain groups make conflicts and other points leave rows open") {
  struct Post {
    std::size_t x;
    double y;
    std::size_t points;
    Verdict verdict;
  };
  // Certainly too close: enough and few. Too close, but not certainly, and near.
  const Post posts[] = {{10, 0.51, 12, Verdict::kConflict},
                        {25, 0.51, 5, Verdict::kUndecided},
                        {40, 0.58, 12, Verdict::kUndecided},
                        {52, 0.63, 12, Verdict::kUndecided}};
  std::vector<Vec3> places;
  for (const Post& one : posts) {
    const std::vector<Vec3> more = post(static_cast<double>(one.x), one.y, one.points);
    places.insert(places.end(), more.begin(), more.end());
  }
  const StationScene scene(places, Query(kCar, straight_path(60), with_budget()));
  const Result result = scene.result();
  REQUIRE(result.near().size() == 12);
  REQUIRE(result.answer().certain.points == 17);
  const StationTable table = scene.table(1);
  for (const Post& one : posts) {
    CAPTURE(one.x);
    for (const std::size_t row : {one.x - 1, one.x}) {
      CHECK(table.rows[row].verdict == one.verdict);
      if (one.verdict == Verdict::kConflict) continue;
      CHECK(table.rows[row].reasons == std::vector{Reason::kNear});
    }
    for (const std::size_t row : {one.x - 3, one.x + 2}) {
      CHECK(table.rows[row].verdict == Verdict::kClear);
    }
  }
}

TEST_CASE("the verdicts of the rows together are that of the result, with a budget") {
  std::map<Verdict, int> met;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    std::vector<Vec3> places{{5, 3, 0}};
    for (int i = -4; i <= 48; ++i) {  // ground, without which a hole would be in doubt
      for (int k = -4; k <= 4; ++k) {
        places.push_back({0.5 * i + 0.007 * (k % 3), 0.5 * k + 0.007 * (i % 3), -2});
      }
    }
    for (int i = 0; i < 3; ++i) {
      const auto more = post(uniform(random, 2, 18), 0.5 + uniform(random, 0, 0.25),
                             5 + static_cast<std::size_t>(below(random, 12)));
      if (below(random, 3) > 0) places.insert(places.end(), more.begin(), more.end());
    }
    const StationScene scene(places, Query(kCar, straight_path(20, 0.05), with_budget()));
    const Verdict verdict = scene.result().answer().verdict();
    ++met[verdict];
    for (const double every : {0.5, 3.0, 50.0}) CHECK(worst_of(scene.table(every)) == verdict);
  }
  check_equal(met.size(), 3);
}

TEST_CASE("a CSV and a JSON of the table have the fixed columns") {
  Query query({}, straight_path(4, 1), {.radius = 0.1, .clearance = 1});
  for (const char* name : {"a,b", "=1+1"}) {
    Body body{name, Model{kCar}, query.poses, {0, 1, 2, 3, 4}};
    if (name[0] == '=') {
      for (Pose& pose : body.poses) pose.translation[2] += 3;
    }
    query.bodies.push_back(std::move(body));
  }
  const StationScene scene({{1, 0.7, 0}, {50, 50, 0}}, query);
  const StationOptions options{.every = 2.5, .bodies = scene.query.bodies};
  const Result result = scene.result();
  const StationTable table = station_table(result, query.poses, options);
  const Answer answer = counted_answer(result.reader());
  const StationFile file{table, options, result.reader().header(), answer};
  write_stations(file, StationFormat::kCsv, scene.folder / "s.csv");
  write_stations(file, StationFormat::kJson, scene.folder / "s.json");
  check_equal(
      bytes_of(scene.folder / "s.csv"),
      R"(chainage_from,chainage_to,station_from,station_to,least,least_source,least_below,left,left_source,right,right_source,above,above_source,verdict,"a,b_overthrow_end","a,b_overthrow_middle","'=1+1_overthrow_end","'=1+1_overthrow_middle",doubts
0,2.5,,,0.2,0,,0.2,0,,,,,clear,0,0,0,0,
2.5,4,,,,,,,,,,,,clear,0,0,0,0,
)");
  const auto parsed = nlohmann::json::parse(bytes_of(scene.folder / "s.json"));
  CHECK(parsed["kind"] == "stations");
  check_equal(parsed["stations"].size(), 2);
  CHECK(parsed["stations"][0]["left_source"] == 0);
  CHECK(parsed["stations"][1]["left"].is_null());
  CHECK(parsed["stations"][1]["a,b_overthrow_end"] == 0);
  CHECK(parsed["station_count"] == 2);
}
