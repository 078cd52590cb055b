// clearway run --vehicle: the file of bodies, and what a wagon finds in the tunnel's curve.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "clearway/result.hpp"
#include "clearway/trajectory.hpp"
#include "io/paths/trajectory_file.hpp"
#include "support/store_fixture.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

namespace {

/// Half the model's width, and the gap between the model's side and the points beside it, metres.
constexpr double kSide = 1.4, kGap = 0.12;

/// The tunnel scene's path, and points on both sides of it. The wagon is a line across its middle,
/// as wide as 2 kSide, and lines across its ends, 13 m ahead and behind.
struct Tunnel {
  Tunnel() {
    const Outcome made = run_program(
        folder, "scene tunnel -o " + quoted(folder / "") + " --points 2000 --model-points 100");
    REQUIRE(made.exit_code == 0);
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
    REQUIRE(run("convert " + name("gauge.las") + " -o " + name("gauge.h5")).exit_code == 0);
    put_bytes(folder / "middle.xyz", "0 -1.4 1\n0 0 1\n0 1.4 1\n");
    put_bytes(folder / "end.xyz", "13 -1.4 1\n13 0 1\n13 1.4 1\n");
  }

  Outcome run(const std::string& arguments) const { return run_program(folder, arguments); }
  Outcome run_on(const std::string& more, const std::string& trajectory = "trajectory.txt") const {
    return run("run --env " + name("gauge.h5") + " --trajectory " + name(trajectory) +
               " --radius 0.05 --first-pose --clearance 0.3 --force -o " + name("out.h5") + " " +
               more);
  }
  Outcome run_vehicle(const std::string& bodies, const std::string& more = "--json") const {
    put_bytes(folder / "wagon.json", "{\"bodies\": [" + bodies + "]}");
    return run_on("--vehicle " + name("wagon.json") + " " + more);
  }
  std::string name(const std::string& file) const { return quoted(folder / file); }

  ScratchFolder folder;
  std::vector<Pose> path;
};

const Tunnel& tunnel() {
  static const Tunnel made;
  return made;
}

}  // namespace

TEST_CASE("the middle of a wagon leaves the gauge where a rigid one does not") {
  const Outcome rigid = tunnel().run_on("--model " + tunnel().name("middle.xyz") + " --json");
  REQUIRE(rigid.exit_code == 0);
  const auto alone = nlohmann::json::parse(rigid.out);
  CHECK(alone["colliding_points"] == 0);
  CHECK(alone["least_clearance"]["distance"] == Approx(kGap).margin(0.01));

  const Outcome wagon =
      tunnel().run_vehicle(R"({"name": "middle", "model": "middle.xyz", "pivots": [10, "-10m"]})");
  REQUIRE(wagon.exit_code == 0);
  const auto report = nlohmann::json::parse(wagon.out);
  CHECK(report["colliding_points"] > 100);
  CHECK(report["first_place"]["body"] == "middle");
  CHECK(report["least_clearance"]["body"] == "middle");
  CHECK(report["files"]["vehicle"] == (tunnel().folder / "wagon.json").string());
  CHECK_THAT(wagon.err, Contains("is off the path"));
  CHECK(report["warnings"].empty() == (wagon.err.find("warning: ") == std::string::npos));
  CHECK(wagon.err.find("warning: " + (tunnel().folder / "wagon.json").string()) ==
        std::string::npos);
  // The verdict is about the part of the path on which the wagon has poses.
  CHECK(report["path_length"].get<double>() - report["searched_length"].get<double>() ==
        Approx(20).margin(1));
  CHECK(report["partly_searched_length"] == 0);
  const auto kept = nlohmann::json::parse(
      run_program(tunnel().folder, "info --json " + tunnel().name("out.h5")).out);
  for (const char* key : {"path_length", "searched_length", "partly_searched_length"}) {
    CHECK(kept[key] == report[key]);
  }
  CHECK_THAT(wagon.err, Contains("; the vehicle was searched on ") && Contains(" of the path"));
  CHECK(alone["searched_length"] == alone["path_length"]);
  CHECK(rigid.err.find("was searched on") == std::string::npos);
  // The chord's middle lies up to 0.156 m inside, so somewhere it meets the points at 0.12 m.
  CHECK(report["least_clearance"]["distance"] < 0.01);
}

TEST_CASE("each body of a vehicle has its own motion and its own name in the result") {
  const std::string middle = R"({"name": "middle", "model": "middle.xyz", "pivots": [10, -10]})";
  const std::string end = R"({"name": "end", "model": "end.xyz", "pivots": [10, -10]})";
  const std::string bogie = R"({"name": "bogie", "model": "middle.xyz", "at": -10.5})";
  REQUIRE(tunnel().run_vehicle(bogie + ", " + middle + ", " + end).exit_code == 0);
  const Result result(tunnel().folder / "out.h5");
  CHECK(result.bodies() == std::vector<std::string>{"bogie", "middle", "end"});
  const auto first = result.first_body();
  const Clearances clearance = result.clearance();
  // A bogie stays on the path and touches nothing.
  CHECK(std::ranges::count(first, 0u) == 0);
  CHECK(std::ranges::count(first, 1u) > 0);
  CHECK(std::ranges::count(clearance.body, 0u) > 0);
  const Outcome info = tunnel().run("info " + tunnel().name("out.h5"));
  CHECK_THAT(info.out, Contains("bogie") && Contains("middle"));
  CHECK(tunnel().run("verify " + tunnel().name("out.h5")).exit_code == 0);
  const Outcome conflicts = tunnel().run("conflicts " + tunnel().name("out.h5") + " --trajectory " +
                                         tunnel().name("trajectory.txt") + " -o " +
                                         tunnel().name("found.json") + " --force");
  REQUIRE(conflicts.exit_code == 0);
  const auto found = nlohmann::json::parse(bytes_of(tunnel().folder / "found.json"));
  CHECK(found["bodies"] == nlohmann::json{"bogie", "middle", "end"});
  REQUIRE(found["conflicts"].size() > 0);
  for (const auto& conflict : found["conflicts"]) {
    CHECK(conflict["body"] > 0);
    CHECK(conflict["body_name"] == found["bodies"][conflict["body"].get<std::size_t>()]);
    CHECK(conflict["side"] == "unknown");
  }
  for (const std::string format : {"csv", "ply", "las"}) {
    const std::string file = "clearances." + format;
    CHECK(tunnel()
              .run("export " + tunnel().name("out.h5") + " -o " + tunnel().name(file) +
                   " --what clearance --force")
              .exit_code == 0);
    CHECK_THAT(bytes_of(tunnel().folder / file), Contains("body"));
  }
}

TEST_CASE("a body with a trajectory of its own moves as a model on it") {
  REQUIRE(tunnel()
              .run("trajectory follow " + tunnel().name("trajectory.txt") + " -o " +
                   tunnel().name("own.txt") + " --at 0 --force")
              .exit_code == 0);
  REQUIRE(tunnel().run_on("--model " + tunnel().name("end.xyz")).exit_code == 0);
  const Result alone(tunnel().folder / "out.h5");
  const auto source = alone.source();
  const auto pose = alone.first_pose();
  REQUIRE(tunnel()
              .run_vehicle(R"({"name": "e", "model": "end.xyz", "trajectory": "own.txt"},)"
                           R"({"name": "p", "model": "end.xyz"})")
              .exit_code == 0);
  const Result both(tunnel().folder / "out.h5");
  CHECK(both.source() == source);
  CHECK(both.first_pose() == pose);
  CHECK(std::ranges::count(both.first_body(), 0u) == static_cast<long>(source.size()));
}

TEST_CASE("every complaint about a vehicle's file names the key") {
  const auto refused = [](const std::string& text, const std::string& words, int code = 3) {
    put_bytes(tunnel().folder / "wagon.json", text);
    const Outcome outcome = tunnel().run_on("--vehicle " + tunnel().name("wagon.json"));
    CHECK(outcome.exit_code == code);
    CHECK_THAT(outcome.err, Contains("wagon.json: " + words));
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
  put_bytes(tunnel().folder / "short.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  refused(body(model + R"("trajectory": "short.txt")"), "bodies[1].trajectory: ");
  refused(R"({"bodies": [{"name": "a", "model": "middle.xyz"}, {"name": "a", "model": "x"}]})",
          "bodies[1].name: \"a\" names another body too");
}

TEST_CASE("run --vehicle excludes what one model needs") {
  const std::string body = R"({"name": "a", "model": "middle.xyz", "at": 2})";
  CHECK_THAT(tunnel().run_vehicle(body, "--engine kdtree").err,
             Contains("--vehicle: engine kdtree"));
  CHECK(tunnel().run_vehicle(body, "--model " + tunnel().name("middle.xyz")).exit_code == 2);
  CHECK(tunnel().run_vehicle(body, "-o " + tunnel().name("middle.xyz")).exit_code == 2);
  const Outcome neither = tunnel().run_on("");
  CHECK(neither.exit_code == 2);
  CHECK_THAT(neither.err, Contains("--model"));
  REQUIRE(tunnel().run_vehicle(body).exit_code == 0);
  const Outcome report =
      tunnel().run("report " + tunnel().name("out.h5") + " --env " + tunnel().name("gauge.h5") +
                   " --model " + tunnel().name("middle.xyz") + " --trajectory " +
                   tunnel().name("trajectory.txt") + " -o " + tunnel().name("report.html"));
  CHECK(report.exit_code == 3);
  CHECK_THAT(report.err, Contains("several bodies"));
}
