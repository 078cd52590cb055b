// run --vehicle --model-as solid: what conflicts and report tell about points inside a body.
#include <nlohmann/json.hpp>
#include <set>

#include "support/catch.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
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
struct YardOfSolids : Workplace {
  YardOfSolids() {
    std::string scan;
    for (int i = 0; i < 100; ++i) {
      for (int k = -15; k <= 15; ++k) scan += at(i * 0.1, k * 0.1, 0);
    }
    for (int k = 0; k < 10; ++k) scan += at(5, 0.6, k * 0.2);
    put("scan.xyz", scan);
    put("path.txt", path_along_x(61, 0.1, 2));
    put("wide.off", box_off(0.8));
    put("narrow.off", box_off(0.4));
    put("open.off", box_off(0.8, true));
    put("points.xyz", "0 0 0.5\n0 0.3 0.5\n0.2 0.1 0.8\n");
    put_vehicle("wide.off");
    require_success(run("convert scan.xyz -o site.h5"));
  }

  static std::string at(double x, double y, double z) {
    return std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
  }
  void put_vehicle(const std::string& truck) const {
    put("wagon.json", R"({"bodies": [{"name": "trailer", "model": "narrow.off", "pivots": [-1, -2]},
                             {"name": "truck", "model": ")" +
                          truck + "\"}]}");
  }
  Outcome search(const std::string& arguments, const std::string& store = "site.h5") const {
    return run("run --env " + store +
               " --trajectory path.txt --radius 0.05 --force --json -o out.h5 " + arguments);
  }
  Outcome search_solid(const std::string& arguments) const {
    return search("--vehicle wagon.json --model-as solid " + arguments);
  }
  json report(const std::string& model) const {
    return json_of(
        require_success(run("report out.h5 --env site.h5 --trajectory path.txt -o page.html " +
                            model + " --force --json")));
  }
};

std::set<std::string> codes_of(const Outcome& outcome) {
  require_success(outcome);
  std::set<std::string> out;
  const json told = json_of(outcome);
  for (const json& warning : told["warnings"]) out.insert(warning["code"]);
  return out;
}

}  // namespace

TEST_CASE("a vehicle of solids tells what is inside and which body it is") {
  const YardOfSolids yard;
  const Outcome run =
      require_success(yard.search_solid("--first-pose --clearance 0.3 --profile 0.3"));
  const json told = json_of(run);
  check_json(told, R"({
    "model_as": "solid", "model_solids": 2, "points_inside": 4,
    "least_clearance": {"body": "truck"}})");
  check_near(told, "/greatest_depth", 0.2, 0.002);
  check_says(run.err, "the greatest depth inside the model is ... body truck");
  check_outcome(yard.run("verify out.h5"), 0);
  check_json(json_of(yard.run("info out.h5 --json")),
             R"({"model_as": "solid", "points_inside": 4, "bodies": ["trailer", "truck"]})");
  yard.succeed("conflicts out.h5 --trajectory path.txt --min-points 1 -o found.json");
  const json found = json::parse(yard.bytes("found.json"));
  REQUIRE(found["conflicts"].size() == 1);
  check_json(found, R"({"conflicts": {"0": {"body_name": "truck", "points_inside": 4}}})");
  CHECK(found["conflicts"][0]["depth"] == told["greatest_depth"]);
  const json facts = yard.report("--vehicle wagon.json");
  check_json(facts, R"({"inside": {"points": 4}})");
  CHECK(facts["inside"]["depth"] == told["greatest_depth"]);
  for (const json& body : facts["inputs"]["model"]["bodies"]) CHECK(body["solids"] == 1);
  // As a surface the model gives another answer.
  const json surface =
      json_of(yard.search("--vehicle wagon.json --model-as surface --clearance 0.3"));
  check_json(surface, R"({"model_as": "surface", "greatest_depth": null})");
}

TEST_CASE("the body of a profile's depth is the one that the point is inside of") {
  const YardOfSolids yard;
  require_success(yard.search_solid("--profile 0.3"));
  const json least = yard.report("--vehicle wagon.json")["least_distance"];
  check_json(least, R"({"of": "profile", "body": "truck"})");
  check_near(least, "/distance", -0.2, 0.002);
}

TEST_CASE("bodies without an inside are refused by their key") {
  const YardOfSolids yard;
  for (const char* model : {"open.off", "points.xyz"}) {
    yard.put_vehicle(model);
    check_outcome(yard.search_solid(""), 3, "wagon.json: bodies[1].model: ");
  }
}

TEST_CASE("what a solid contains is no reason to warn") {
  const YardOfSolids yard;
  std::string things = yard.bytes("scan.xyz");
  for (int i = 0; i < 1000; ++i) {
    things +=
        YardOfSolids::at(2 + 0.02 * (i / 100 - 5), 0.02 * (i / 10 % 10 - 5), 0.7 + 0.02 * (i % 10));
  }
  yard.put("things.xyz", things);
  yard.succeed("convert things.xyz -o things.h5");
  for (const std::string model : {"--model wide.off ", "--vehicle wagon.json "}) {
    const auto warned = [&](const std::string& as) {
      return codes_of(yard.search(model + as, "things.h5")).count("inside-model");
    };
    CHECK(warned("--model-as surface") == 1);
    CHECK(warned("--model-as solid") == 0);
    CHECK(warned("") == 0);  // the bodies are closed
  }
}
