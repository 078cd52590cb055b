// clearway run --vehicle: the file of bodies, and what a wagon finds in the tunnel's curve.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "clearway/result.hpp"
#include "clearway/trajectory.hpp"
#include "io/paths/trajectory_file.hpp"
#include "support/catch.hpp"
#include "support/store_fixture.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Half the model's width, and the gap between the model's side and the points beside it, metres.
constexpr double kSide = 1.4, kGap = 0.12;

/// The tunnel scene's path, and points on both sides of it. The wagon is a line across its middle,
/// as wide as 2 kSide, and lines across its ends, 13 m ahead and behind.
struct Tunnel : Workplace {
  Tunnel() {
    succeed("scene tunnel -o . --points 2000 --model-points 100");
    path = read_trajectory(folder / "trajectory.txt");
    std::vector<Quantum> points;
    for (const Pose& pose : path) {
      for (const double side : {-1.0, 1.0}) {
        const double y = side * (kSide + kGap);
        Quantum q{};
        for (std::size_t k = 0; k < 3; ++k) {
          const double at =
              pose.translation[k] + pose.rotation[3 * k + 1] * y + pose.rotation[3 * k + 2];
          q[k] = static_cast<std::int32_t>(std::llround(at * 1000));
        }
        points.push_back(q);
      }
    }
    write_las(folder / "gauge.las", points, {{0.001, 0.001, 0.001}, {0, 0, 0}});
    require_success(run("convert gauge.las -o gauge.h5"));
    put("middle.xyz", "0 -1.4 1\n0 0 1\n0 1.4 1\n");
    put("end.xyz", "13 -1.4 1\n13 0 1\n13 1.4 1\n");
  }

  Outcome run_on(const std::string& more, const std::string& trajectory = "trajectory.txt") const {
    return run("run --env gauge.h5 --trajectory " + trajectory +
               " --radius 0.05 --first-pose --clearance 0.3 --force -o out.h5 " + more);
  }
  Outcome run_vehicle(const std::string& bodies, const std::string& more = "--json") const {
    put("wagon.json", "{\"bodies\": [" + bodies + "]}");
    return run_on("--vehicle wagon.json " + more);
  }

  std::vector<Pose> path;
};

const Tunnel& tunnel() {
  static const Tunnel made;
  return made;
}

}  // namespace

TEST_CASE("the middle of a wagon leaves the gauge where a rigid one does not") {
  const Outcome rigid = require_success(tunnel().run_on("--model middle.xyz --json"));
  const auto alone = json_of(rigid);
  check_json(alone, R"({"colliding_points": 0})");
  check_near(alone, "/least_clearance/distance", kGap, 0.01);

  const Outcome wagon = require_success(
      tunnel().run_vehicle(R"({"name": "middle", "model": "middle.xyz", "pivots": [10, "-10m"]})"));
  const auto report = json_of(wagon);
  CHECK(report["colliding_points"] > 100);
  check_json(report, R"({
    "first_place": {"body": "middle"}, "least_clearance": {"body": "middle"},
    "files": {"vehicle": "wagon.json"}})");
  check_says(wagon.err, "is off the path");
  CHECK(report["warnings"].empty() == (wagon.err.find("warning: ") == std::string::npos));
  check_lacks(wagon.err, "warning: wagon.json");
  // The verdict is about the part of the path on which the wagon has poses.
  CHECK(report["path_length"].get<double>() - report["searched_length"].get<double>() ==
        Approx(20).margin(1));
  check_json(report, R"({"partly_searched_length": 0})");
  const auto kept = json_of(tunnel().run("info --json out.h5"));
  for (const char* key : {"path_length", "searched_length", "partly_searched_length"}) {
    CHECK(kept[key] == report[key]);
  }
  check_says(wagon.err, "; the vehicle was searched on  ...  of the path");
  CHECK(alone["searched_length"] == alone["path_length"]);
  CHECK(rigid.err.find("was searched on") == std::string::npos);
  // The chord's middle lies up to 0.156 m inside, so somewhere it meets the points at 0.12 m.
  CHECK(report["least_clearance"]["distance"] < 0.01);
}

TEST_CASE("each body of a vehicle has its own motion and its own name in the result") {
  const std::string middle = R"({"name": "middle", "model": "middle.xyz", "pivots": [10, -10]})";
  const std::string end = R"({"name": "end", "model": "end.xyz", "pivots": [10, -10]})";
  const std::string bogie = R"({"name": "bogie", "model": "middle.xyz", "at": -10.5})";
  require_success(tunnel().run_vehicle(bogie + ", " + middle + ", " + end));
  const Result result(tunnel().folder / "out.h5");
  CHECK(result.bodies() == std::vector<std::string>{"bogie", "middle", "end"});
  const auto first = result.first_body();
  const Clearances clearance = result.clearance();
  // A bogie stays on the path and touches nothing.
  CHECK(std::ranges::count(first, 0u) == 0);
  CHECK(std::ranges::count(first, 1u) > 0);
  CHECK(std::ranges::count(clearance.body, 0u) > 0);
  check_says(tunnel().run("info out.h5").out, "bogie ... middle");
  check_outcome(tunnel().run("verify out.h5"), 0);
  const Outcome conflicts =
      tunnel().succeed("conflicts out.h5 --trajectory trajectory.txt -o found.json --force");
  const auto found = nlohmann::json::parse(tunnel().bytes("found.json"));
  CHECK(found["bodies"] == nlohmann::json{"bogie", "middle", "end"});
  REQUIRE(found["conflicts"].size() > 0);
  for (const auto& conflict : found["conflicts"]) {
    CHECK(conflict["body"] > 0);
    CHECK(conflict["body_name"] == found["bodies"][conflict["body"].get<std::size_t>()]);
    check_json(conflict, R"({"side": "unknown"})");
  }
  for (const std::string format : {"csv", "ply", "las"}) {
    const std::string file = "clearances." + format;
    check_outcome(tunnel().run("export out.h5 -o " + file + " --what clearance --force"), 0);
    check_says(tunnel().bytes(file), "body");
  }
}

TEST_CASE("a body with a trajectory of its own moves as a model on it") {
  tunnel().succeed("trajectory follow trajectory.txt -o own.txt --at 0 --force");
  require_success(tunnel().run_on("--model end.xyz"));
  const Result alone(tunnel().folder / "out.h5");
  const auto source = alone.source();
  const auto pose = alone.first_pose();
  require_success(
      tunnel().run_vehicle(R"({"name": "e", "model": "end.xyz", "trajectory": "own.txt"},)"
                           R"({"name": "p", "model": "end.xyz"})"));
  const Result both(tunnel().folder / "out.h5");
  CHECK(both.source() == source);
  CHECK(both.first_pose() == pose);
  CHECK(std::ranges::count(both.first_body(), 0u) == static_cast<long>(source.size()));
}

TEST_CASE("every complaint about a vehicle's file names the key") {
  const auto refused = [](const std::string& text, const std::string& words, int code = 3) {
    tunnel().put("wagon.json", text);
    const Outcome outcome = tunnel().run_on("--vehicle wagon.json");
    CHECK(outcome.exit_code == code);
    check_says(outcome.err, "wagon.json: " + words);
  };
  const auto body = [](const std::string& more) {
    return R"({"bodies": [{"name": "a", "model": "middle.xyz"}, {"name": "b", )" + more + "}]}";
  };
  const std::string model = R"("model": "middle.xyz", )";
  refused("{", "is no JSON");
  refused("[]", "expected one JSON object");
  refused("{\"bodies\": " + std::string(100'000, '['), "line 1, column 75: lists and objects");
  std::string many = R"({"bodies": [0)";
  for (int i = 0; i < 300'000; ++i) many += R"(,{"name": "a", "model": "middle.xyz"})";
  refused(many + "]}", "bodies: has 300,001 entries, expected at most 256");
  refused("{}", "bodies: is missing");
  refused(R"({"bodies": []})", "bodies: is empty");
  refused(R"({"bodies": [], "unit": "m"})", "unit: unknown key");
  refused(body(R"("at": 1)"), "bodies[1].model: is missing");
  refused(body(model + R"("at": 1, "pivots": [1, -1])"), "bodies[1]: a body moves in one way");
  refused(body(model + R"("at": "far")"), "bodies[1].at: is \"far\", expected a length");
  refused(body(model + R"("at": true)"), "bodies[1].at: expected a length");
  refused(body(model + R"("pivots": [1])"), "bodies[1].pivots: expected two lengths");
  refused(body(model + R"("pivots": [1, "100cm"])"), "bodies[1].pivots: expected two different");
  refused(body(model + R"("pivots": [1, []])"), "bodies[1].pivots[1]: expected a length");
  refused(body(model + R"("station": 1)"), "bodies[1].station: unknown key");
  refused(body(model + R"("model_unit": "mile")"), "bodies[1].model_unit: is \"mile\"");
  refused(body(model + R"("at": 1e6)"), "bodies[1]: the path is");
  refused(body(R"("model": "none.xyz")"), "bodies[1].model: ", 4);
  refused(body(model + R"("trajectory": "none.txt")"), "bodies[1].trajectory: ", 4);
  tunnel().put("short.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  refused(body(model + R"("trajectory": "short.txt")"), "bodies[1].trajectory: ");
  refused(R"({"bodies": [{"name": "a", "model": "middle.xyz"}, {"name": "a", "model": "x"}]})",
          "bodies[1].name: \"a\" names another body too");
}

TEST_CASE("run --vehicle excludes what one model needs") {
  const std::string body = R"({"name": "a", "model": "middle.xyz", "at": 2})";
  check_says(tunnel().run_vehicle(body, "--engine kdtree").err, "--vehicle: engine kdtree");
  check_outcome(tunnel().run_vehicle(body, "--model middle.xyz"), 2);
  check_outcome(tunnel().run_vehicle(body, "-o middle.xyz"), 2);
  check_outcome(tunnel().run_on(""), 2, "--model");
  require_success(tunnel().run_vehicle(body));
  check_outcome(tunnel().run("report out.h5 --env gauge.h5 --model middle.xyz --trajectory "
                             "trajectory.txt -o report.html"),
                3, "several bodies");
}
