#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clearway/result.hpp"
#include "support/catch.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;

namespace {

/// A model of one point that stands still at the origin, and points of a scan at distances along x,
/// on a step of 1 mm.
struct Bench : Workplace {
  Bench() {
    put("car.xyz", "0 0 0\n");
    put("path.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0.001 0 1 0 0 0 0 1 0\n");
  }

  void scan(const std::string& points, const std::string& scale = "0.001",
            const std::string& options = "") const {
    put("scan.xyz", points);
    require_success(run("convert scan.xyz -o site.h5 --force --scale " + scale + " " + options));
  }

  Outcome search(const std::string& arguments, const std::string& out = "out.h5",
                 const std::string& model = "car.xyz") const {
    return run("run --env site.h5 --model " + model + " --trajectory path.txt -o " + out +
               " --threads 2 --force " + arguments);
  }

  json answer(const std::string& arguments) const {
    return json_of(require_success(search(arguments + " --json")));
  }
};

/// `count` points at x, 1 cm apart along y; all are at most 0.05 m from the x axis.
std::string wall(double x, int count, double apart = 0.01) {
  std::string text;
  for (int i = 0; i < count; ++i) {
    text += std::to_string(x) + " " + std::to_string((i - count / 2) * apart) + " 0\n";
  }
  return text;
}

/// The words of a list of reasons.
std::vector<std::string> reasons_of(const json& report) { return report["reasons"]; }

using Words = std::vector<std::string>;

/// A number with all its digits.
std::string digits(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

}  // namespace

TEST_CASE("without errors nothing of a run changes") {
  const Bench bench;
  bench.scan(wall(0.4, 12) + "5 0 0\n");
  const json report = bench.answer("--radius 0.5 --first-pose");
  check_json(report, R"({"verdict": "conflict", "margins": null})");
  CHECK_FALSE(report.contains("near_points"));
  check_json(json_of(bench.run("info --json out.h5")), R"({"version": 6})");
}

TEST_CASE("a point is near closer than the margin plus U_clear, to the last digit") {
  const Bench bench;
  bench.put("path.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");  // one pose, so no motion
  bench.scan("0.25 0 0\n5 0 0\n", "0.0009765625");
  const double step = std::sqrt(3.0) * 0.0009765625 / 2;
  const json report = bench.answer("--radius 0.1 --error-model 0.05");
  const double clear = report["margins"]["clear"];
  CHECK(clear == Approx(0.05 + step));
  CHECK(report["margins"]["conflict"].get<double>() == clear);
  // Margins for which fl(m + U_clear) is 0.25, and its neighbours on both sides.
  double margin = 0.25 - clear;
  while (margin + clear > 0.25) margin = std::nextafter(margin, 0.0);
  while (margin + clear < 0.25) margin = std::nextafter(margin, 1.0);
  REQUIRE(margin + clear == 0.25);
  double above = margin, below = margin;
  while (above + clear == 0.25) above = std::nextafter(above, 1.0);
  while (below + clear == 0.25) below = std::nextafter(below, 0.0);
  REQUIRE(above + clear == std::nextafter(0.25, 1.0));
  REQUIRE(below + clear == std::nextafter(0.25, 0.0));
  for (const double m : {below, margin}) {
    const json at = bench.answer("--error-model 0.05 --radius " + digits(m));
    check_json(at, R"({"verdict": "clear", "near_points": 0})");
    CHECK(reasons_of(at).empty());
  }
  const json beyond = bench.answer("--error-model 0.05 --radius " + digits(above));
  check_json(beyond, R"({"verdict": "undecided", "near_points": 1, "colliding_points": 0})");
  CHECK(reasons_of(beyond) == Words{"near"});
}

TEST_CASE("more than 65,536 colliding points, an odd number, are written with what is certain") {
  const Bench bench;
  std::string points;
  for (int i = 0; i < 70'001; ++i) {
    points += (i % 2 == 0 ? "0.04 0." : "0.098 0.") + std::to_string(100'000 + i) + " 0\n";
  }
  bench.scan(points, "0.000001");
  const json report = bench.answer("--radius 0.3 --error-model 0.1 --first-pose");
  check_json(report, R"({"colliding_points": 70001})");
  check_outcome(bench.run("verify out.h5"), 0);
  const std::vector<std::uint8_t> certain = Result(bench.folder / "out.h5").collisions().certain;
  CHECK(certain.size() == 70'001);
  CHECK(report["certain_points"] == std::count(certain.begin(), certain.end(), 1));
}

TEST_CASE(
    "ten points that hang together and are certainly too close are a conflict, nine are few") {
  const Bench bench;
  const std::string query = "--radius 0.5 --error-model 0.05 --first-pose ";
  bench.scan(wall(0.4, 9) + "5 0 0\n");
  const json nine = bench.answer(query);
  check_json(nine, R"({"certain_points": 9, "verdict": "undecided"})");
  CHECK(reasons_of(nine) == Words{"near", "few"});
  check_outcome(bench.search(query + "--fail-on-collision"), 6);

  bench.scan(wall(0.4, 10) + "5 0 0\n");
  const json ten = bench.answer(query);
  check_json(ten, R"({"certain_points": 10, "verdict": "conflict"})");
  CHECK(reasons_of(ten).empty());
  check_outcome(bench.search(query + "--fail-on-collision"), 1);
  // Ten points that are farther apart than the gap do not hang together.
  CHECK(bench.answer(query + "--gap 0.005")["verdict"] == "undecided");

  const json listed =
      json_of(bench.run("conflicts --json out.h5 --trajectory path.txt --min-points 1"));
  check_json(listed, R"({"verdict": "undecided"})");
  check_near(listed, "/margins/conflict", 0.050866, 1e-5);
}

TEST_CASE("points that collide but may be far enough leave the verdict open") {
  const Bench bench;
  bench.scan(wall(0.48, 20) + "5 0 0\n");
  const json report = bench.answer("--radius 0.5 --error-scan 0.01 --first-pose");
  check_json(report, R"({"colliding_points": 20, "certain_points": 0, "verdict": "undecided"})");
  CHECK(reasons_of(report) == Words{"near"});
  // Where the errors exceed the margin, no surface can be a certain conflict.
  const json large = bench.answer("--radius 0.5 --error-scan 0.1 --first-pose");
  CHECK(reasons_of(large) == Words{"near", "errors-exceed-margin"});
  check_json(large, R"({"verdict": "undecided"})");
  check_says(bench.search("--radius 0.5 --error-scan 0.1").err,
             "so that no point outside the vehicle is certainly too close");
}

TEST_CASE("a solid can be a certain conflict at any margin, by its depth") {
  const Bench bench;
  std::string off = "OFF\n8 12 0\n";
  for (const char* corner :
       {"-1 -1 -1", "1 -1 -1", "1 1 -1", "-1 1 -1", "-1 -1 1", "1 -1 1", "1 1 1", "-1 1 1"}) {
    off += std::string(corner) + "\n";
  }
  for (const char* triangle : {"0 2 1", "0 3 2", "4 5 6", "4 6 7", "0 1 5", "0 5 4", "1 2 6",
                               "1 6 5", "2 3 7", "2 7 6", "3 0 4", "3 4 7"}) {
    off += "3 " + std::string(triangle) + "\n";
  }
  bench.put("box.off", off);
  bench.scan(wall(0.05, 10) + "5 0 0\n");  // 0.949 to 0.95 m deep
  const auto judged = [&](const std::string& error) {
    return json_of(require_success(bench.search(
        "--radius 0.1 --model-as solid --json --error-model " + error, "out.h5", "box.off")));
  };
  CHECK(judged("0.05")["verdict"] == "conflict");  // a radius above 0
  CHECK(judged("0.5")["verdict"] == "conflict");
  CHECK(judged("1.04")["verdict"] == "conflict");
  const json deep = judged("1.06");
  check_json(deep, R"({"verdict": "undecided", "certain_points": 0})");
  CHECK(reasons_of(deep) == Words{"near", "question-in-doubt"});  // a box below the ground
}

TEST_CASE("parts with an error budget merge to the bytes of the whole, and resume to the same") {
  const Bench bench;
  std::string points;
  for (int i = 0; i < 3000; ++i) {
    points += std::to_string(0.12 + 0.0005 * i) + " " + std::to_string(0.01 * (i % 40)) + " " +
              std::to_string(0.01 * (i % 7)) + "\n";
  }
  bench.scan(points, "0.001", "--cell-points 100");
  const std::string query = "--radius 0.4 --error-scan 0.01 --error-pose 0.05 --first-pose ";
  require_success(bench.search(query, "whole.h5"));
  std::string parts;
  for (const std::string part : {"1", "2", "3"}) {
    const std::string name = std::string("part") + part + ".h5";
    const json report =
        json_of(require_success(bench.search(query + "--json --shard " + part + "/3", name)));
    CHECK((report["verdict"] == "unknown" || report["verdict"] == "conflict"));
    CHECK(reasons_of(report).empty());
    parts += name + " ";
  }
  const Outcome merged = bench.succeed("merge " + parts + "-o merged.h5 --json");
  const json whole = json_of(bench.run("info --json whole.h5"));
  check_json(whole, R"({"version": 6})");
  CHECK(whole["near_points"].get<int>() > 0);
  CHECK(whole["certain_points"].get<int>() > 0);
  CHECK(json_of(merged)["verdict"] == whole["verdict"]);
  CHECK(json_of(merged)["near_points"] == whole["near_points"]);
  check_same(bench.bytes("merged.h5"), bench.bytes("whole.h5"));
  check_outcome(bench.run("verify whole.h5"), 0);
  check_outcome(bench.run("compare whole.h5 merged.h5"), 0);

  const Outcome again = bench.succeed(
      "run --env site.h5 --model car.xyz --trajectory path.txt -o whole.h5 --resume --json " +
      query);
  check_json(json_of(again), R"({"was_finished": true})");
  CHECK(json_of(again)["verdict"] == whole["verdict"]);
  CHECK(json_of(again)["margins"] == whole["margins"]);
}

TEST_CASE("an error of 0 is a budget, and leaves the colliding points as they are") {
  const Bench bench;
  bench.scan(wall(0.4, 12) + "5 0 0\n");
  require_success(bench.search("--radius 0.5 --first-pose", "whole.h5"));
  const json report = bench.answer("--radius 0.5 --first-pose --error-scan 0");
  check_json(report, R"({"verdict": "conflict"})");
  check_near(report, "/margins/conflict", std::sqrt(3e-6) / 2);
  const json a = json_of(bench.run("info --json whole.h5"));
  const json b = json_of(bench.run("info --json out.h5"));
  CHECK(a["colliding_points"] == b["colliding_points"]);
}

TEST_CASE("conflicts are certain or possible, and near points are listed as possible") {
  const Bench bench;
  bench.scan(wall(0.4, 12) + wall(-0.55, 12) + "5 0 0\n");
  check_json(bench.answer("--radius 0.5 --error-model 0.08 --first-pose"),
             R"({"near_points": 12})");
  bench.succeed("conflicts out.h5 --trajectory path.txt -o out.csv --force");
  std::ifstream file(bench.folder / "out.csv");
  std::string line, all;
  while (std::getline(file, line)) all += line + "\n";
  check_says(all, "class");
  check_says(all, "certain");
  check_says(all, "possible");
}

TEST_CASE("errors that are none, and what a budget cannot be combined with, are refused") {
  const Bench bench;
  bench.scan("0.4 0 0\n5 0 0\n");
  for (const char* wrong : {"--error-scan=-0.1", "--error-scan nan", "--error-pose inf",
                            "--error-angle=-1", "--error-angle nan", "--sigmas 2", "--gap 0.2",
                            "--error-scan 0.01 --sigmas=-1", "--error-scan 0.01 --sigmas nan"}) {
    CAPTURE(wrong);
    check_outcome(bench.search(std::string("--radius 0.1 ") + wrong), 2);
  }
  check_json(bench.answer("--radius 0.1 --error-angle 1deg"), R"({"verdict": "clear"})");
}

TEST_CASE("near points are compared and exported as colliding ones are") {
  const Bench bench;
  bench.scan(wall(0.4, 12) + "0.56 0 0\n0.58 0.01 0\n0.7 0 0\n5 0 0\n");
  require_success(bench.search("--radius 0.5 --first-pose --error-model 0.1", "out.h5"));
  require_success(bench.search("--radius 0.5 --first-pose --error-model 0.1", "whole.h5"));
  const Outcome same = bench.run("compare out.h5 whole.h5 --json");
  check_outcome(same, 0);
  CHECK(json_of(same)["near"] == json{{"in_a", 2},
                                      {"in_b", 2},
                                      {"common", 2},
                                      {"only_in_a", 0},
                                      {"only_in_b", 0},
                                      {"differing", 0}});
  require_success(bench.search("--radius 0.5 --first-pose --error-model 0.3", "whole.h5"));
  check_outcome(bench.run("compare out.h5 whole.h5"), 1, kAnything,
                "only in a: 0\nonly in b: 0\n ... near points in both: 2, only in a: 0, only in b: "
                "1 ... different");
  bench.succeed("export out.h5 --what near -o out.csv --force");
  check_same(bench.bytes("out.csv"), "source,x,y,z,first_pose\n12,0.56,0,0,0\n13,0.58,0.01,0,0\n");
  require_success(bench.search("--radius 0.5 --first-pose", "whole.h5"));
  const Outcome without = bench.run("compare out.h5 whole.h5 --json");
  check_outcome(without, 0);
  CHECK_FALSE(json_of(without).contains("near"));
  check_outcome(bench.run("export whole.h5 --what near -o out.csv --force"), 2,
                "had no error budget");
}

TEST_CASE("without --gap points hang together within 0.3 m, also in feet") {
  const Bench bench;
  // Points 0.5 units apart are within 0.3 m of their neighbours in feet, and not in metres.
  bench.scan(wall(0.1, 12, 0.5), "0.001", "--unit ift");
  CHECK(bench.answer("--radius 30 --error-model 0.01")["verdict"] == "conflict");
  const json info = json_of(bench.run("info --json out.h5"));
  check_near(info, "/gap", 0.3 / 0.3048);
  CHECK(bench.answer("--radius 30 --error-model 0.01 --gap 0.3")["verdict"] == "undecided");
  bench.scan(wall(0.1, 12, 0.5));
  CHECK(bench.answer("--radius 30 --error-model 0.01")["verdict"] == "undecided");
  check_json(json_of(bench.run("info --json out.h5")), R"({"gap": 0.3})");
  check_outcome(bench.search("--radius 30 --error-model 0.01 --gap 0"), 2, "--gap");
}
