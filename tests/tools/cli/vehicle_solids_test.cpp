// run --vehicle --model-as solid: what conflicts and report tell about points inside a body.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <set>

#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;
using nlohmann::json;

namespace {

/// A box from x = -0.5 to 0.5, -half_width to half_width along y, and z = 0.3 to 1.1, in OFF.
/// is_open: one triangle is left out.
std::string box_off(double half_width, bool is_open = false) {
  std::string text = is_open ? "OFF\n8 11 0\n" : "OFF\n8 12 0\n";
  for (int corner = 0; corner < 8; ++corner) {
    text += std::to_string((corner & 1) != 0 ? 0.5 : -0.5) + " " +
            std::to_string((corner & 2) != 0 ? half_width : -half_width) + " " +
            ((corner & 4) != 0 ? "1.1\n" : "0.3\n");
  }
  text +=
      "3 0 2 1\n3 1 2 3\n3 4 5 6\n3 5 7 6\n3 0 1 4\n3 1 5 4\n3 2 6 3\n3 3 6 7\n"
      "3 0 4 2\n3 2 4 6\n3 1 3 5\n";
  return is_open ? text : text + "3 3 7 5\n";
}

/// Ground, and a post at x = 5, 0.6 m beside a path along x. The truck is so wide that the post is
/// up to 0.2 m inside it; the trailer passes the post.
struct YardOfSolids {
  YardOfSolids() {
    std::string scan, path;
    for (int i = 0; i < 100; ++i) {
      for (int k = -15; k <= 15; ++k) scan += at(i * 0.1, k * 0.1, 0);
    }
    for (int k = 0; k < 10; ++k) scan += at(5, 0.6, k * 0.2);
    for (int i = 0; i <= 60; ++i) {
      path += "1 0 0 " + std::to_string(2 + i * 0.1) + " 0 1 0 0 0 0 1 0\n";
    }
    put_bytes(folder / "scan.xyz", scan);
    put_bytes(folder / "path.txt", path);
    put_bytes(folder / "wide.off", box_off(0.8));
    put_bytes(folder / "narrow.off", box_off(0.4));
    put_bytes(folder / "open.off", box_off(0.8, true));
    put_bytes(folder / "points.xyz", "0 0 0.5\n0 0.3 0.5\n0.2 0.1 0.8\n");
    put_vehicle("wide.off");
    REQUIRE(program("convert scan.xyz -o site.h5").exit_code == 0);
  }

  static std::string at(double x, double y, double z) {
    return std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
  }
  void put_vehicle(const std::string& truck) const {
    put_bytes(folder / "wagon.json",
              R"({"bodies": [{"name": "trailer", "model": "narrow.off", "pivots": [-1, -2]},
                             {"name": "truck", "model": ")" +
                  truck + "\"}]}");
  }
  Outcome program(const std::string& arguments) const {
    return run_program_at("env", folder,
                          "-C " + quoted(folder / "") + " '" CLEARWAY_PROGRAM "' " + arguments);
  }
  Outcome run(const std::string& arguments, const std::string& store = "site.h5") const {
    return program("run --env " + store + " --trajectory path.txt --radius 0.05 --force --json " +
                   "-o out.h5 " + arguments);
  }
  Outcome run_solid(const std::string& arguments) const {
    return run("--vehicle wagon.json --model-as solid " + arguments);
  }
  json report(const std::string& model) const {
    const Outcome made = program("report out.h5 --env site.h5 --trajectory path.txt -o page.html " +
                                 model + " --force --json");
    INFO(made.err);
    REQUIRE(made.exit_code == 0);
    return json::parse(made.out);
  }

  ScratchFolder folder;
};

std::set<std::string> codes_of(const Outcome& outcome) {
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  std::set<std::string> out;
  const json told = json::parse(outcome.out);
  for (const json& warning : told["warnings"]) out.insert(warning["code"]);
  return out;
}

}  // namespace

TEST_CASE("a vehicle of solids tells what is inside and which body it is") {
  const YardOfSolids yard;
  const Outcome run = yard.run_solid("--first-pose --clearance 0.3 --profile 0.3");
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const json told = json::parse(run.out);
  CHECK(told["model_as"] == "solid");
  CHECK(told["model_solids"] == 2);
  CHECK(told["points_inside"] == 4);
  CHECK(told["greatest_depth"].get<double>() == Approx(0.2).margin(0.002));
  CHECK(told["least_clearance"]["body"] == "truck");
  CHECK_THAT(run.err, Contains("the greatest depth inside the model is") && Contains("body truck"));
  CHECK(yard.program("verify out.h5").exit_code == 0);
  const json info = json::parse(yard.program("info out.h5 --json").out);
  CHECK(info["model_as"] == "solid");
  CHECK(info["points_inside"] == 4);
  CHECK(info["bodies"] == json{"trailer", "truck"});
  REQUIRE(yard.program("conflicts out.h5 --trajectory path.txt --min-points 1 -o found.json")
              .exit_code == 0);
  const json found = json::parse(bytes_of(yard.folder / "found.json"));
  REQUIRE(found["conflicts"].size() == 1);
  CHECK(found["conflicts"][0]["body_name"] == "truck");
  CHECK(found["conflicts"][0]["points_inside"] == 4);
  CHECK(found["conflicts"][0]["depth"] == told["greatest_depth"]);
  const json facts = yard.report("--vehicle wagon.json");
  CHECK(facts["inside"]["points"] == 4);
  CHECK(facts["inside"]["depth"] == told["greatest_depth"]);
  for (const json& body : facts["inputs"]["model"]["bodies"]) CHECK(body["solids"] == 1);
  // As a surface the model gives another answer.
  const json surface = json::parse(yard.run("--vehicle wagon.json --clearance 0.3").out);
  CHECK(surface["model_as"] == "surface");
  CHECK(surface["greatest_depth"].is_null());
}

TEST_CASE("the body of a profile's depth is the one that the point is inside of") {
  const YardOfSolids yard;
  const Outcome run = yard.run_solid("--profile 0.3");
  REQUIRE(run.exit_code == 0);
  const json least = yard.report("--vehicle wagon.json")["least_distance"];
  CHECK(least["of"] == "profile");
  CHECK(least["distance"].get<double>() == Approx(-0.2).margin(0.002));
  CHECK(least["body"] == "truck");
}

TEST_CASE("bodies without an inside are refused by their key") {
  const YardOfSolids yard;
  for (const char* model : {"open.off", "points.xyz"}) {
    yard.put_vehicle(model);
    const Outcome refused = yard.run_solid("");
    CHECK(refused.exit_code == 3);
    CHECK_THAT(refused.err, Contains("wagon.json: bodies[1].model: "));
  }
}

TEST_CASE("what a solid contains is no reason to warn") {
  const YardOfSolids yard;
  std::string things = bytes_of(yard.folder / "scan.xyz");
  for (int i = 0; i < 1000; ++i) {
    things +=
        YardOfSolids::at(2 + 0.02 * (i / 100 - 5), 0.02 * (i / 10 % 10 - 5), 0.7 + 0.02 * (i % 10));
  }
  put_bytes(yard.folder / "things.xyz", things);
  REQUIRE(yard.program("convert things.xyz -o things.h5").exit_code == 0);
  for (const std::string model : {"--model wide.off ", "--vehicle wagon.json "}) {
    CHECK(codes_of(yard.run(model, "things.h5")).count("inside-model") == 1);
    CHECK(codes_of(yard.run(model + "--model-as solid", "things.h5")).count("inside-model") == 0);
  }
}
