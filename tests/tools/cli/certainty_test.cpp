#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clearway/result.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;
using nlohmann::json;

namespace {

/// A model of one point that stands still at the origin, and points of a scan at distances along x,
/// on a step of 1 mm.
struct Bench {
  Bench() {
    put_bytes(folder / "car.xyz", "0 0 0\n");
    put_bytes(folder / "path.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0.001 0 1 0 0 0 0 1 0\n");
  }

  void scan(const std::string& points, const std::string& scale = "0.001",
            const std::string& options = "") const {
    put_bytes(folder / "scan.xyz", points);
    const Outcome outcome =
        program("convert scan.xyz -o site.h5 --force --scale " + scale + " " + options);
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
  }

  Outcome program(std::string arguments) const {
    for (const char* name :
         {"scan.xyz", "site.h5", "car.xyz", "box.off", "path.txt", "out.h5", "out.csv", "part1.h5",
          "part2.h5", "part3.h5", "merged.h5", "whole.h5"}) {
      const auto at = arguments.find(name);
      if (at == std::string::npos) continue;
      arguments.replace(at, std::string(name).size(), quoted(folder / name));
    }
    return run_program(folder, arguments);
  }

  Outcome run(const std::string& arguments, const std::string& out = "out.h5",
              const std::string& model = "car.xyz") const {
    return program("run --env site.h5 --model " + model + " --trajectory path.txt -o " + out +
                   " --threads 2 --force " + arguments);
  }

  json answer(const std::string& arguments) const {
    const Outcome outcome = run(arguments + " --json");
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
    return json::parse(outcome.out);
  }

  ScratchFolder folder;
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
  CHECK(report["verdict"] == "conflict");
  CHECK(report["margins"].is_null());
  CHECK_FALSE(report.contains("near_points"));
  const json info = json::parse(bench.program("info --json out.h5").out);
  CHECK(info["version"] == 6);
}

TEST_CASE("a point is near closer than the margin plus U_clear, to the last digit") {
  const Bench bench;
  put_bytes(bench.folder / "path.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");  // one pose, so no motion
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
    CHECK(at["verdict"] == "clear");
    CHECK(at["near_points"] == 0);
    CHECK(reasons_of(at).empty());
  }
  const json beyond = bench.answer("--error-model 0.05 --radius " + digits(above));
  CHECK(beyond["verdict"] == "undecided");
  CHECK(beyond["near_points"] == 1);
  CHECK(beyond["colliding_points"] == 0);
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
  CHECK(report["colliding_points"] == 70'001);
  CHECK(bench.program("verify out.h5").exit_code == 0);
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
  CHECK(nine["certain_points"] == 9);
  CHECK(nine["verdict"] == "undecided");
  CHECK(reasons_of(nine) == Words{"near", "few"});
  CHECK(bench.run(query + "--fail-on-collision").exit_code == 6);

  bench.scan(wall(0.4, 10) + "5 0 0\n");
  const json ten = bench.answer(query);
  CHECK(ten["certain_points"] == 10);
  CHECK(ten["verdict"] == "conflict");
  CHECK(reasons_of(ten).empty());
  CHECK(bench.run(query + "--fail-on-collision").exit_code == 1);
  // Ten points that are farther apart than the gap do not hang together.
  CHECK(bench.answer(query + "--gap 0.005")["verdict"] == "undecided");

  const json listed = json::parse(
      bench.program("conflicts --json out.h5 --trajectory path.txt --min-points 1").out);
  CHECK(listed["verdict"] == "undecided");
  CHECK(listed["margins"]["conflict"].get<double>() == Approx(0.050866).margin(1e-5));
}

TEST_CASE("points that collide but may be far enough leave the verdict open") {
  const Bench bench;
  bench.scan(wall(0.48, 20) + "5 0 0\n");
  const json report = bench.answer("--radius 0.5 --error-scan 0.01 --first-pose");
  CHECK(report["colliding_points"] == 20);
  CHECK(report["certain_points"] == 0);
  CHECK(report["verdict"] == "undecided");
  CHECK(reasons_of(report) == Words{"near"});
  // Where the errors exceed the margin, no surface can be a certain conflict.
  const json large = bench.answer("--radius 0.5 --error-scan 0.1 --first-pose");
  CHECK(reasons_of(large) == Words{"near", "errors-exceed-margin"});
  CHECK(large["verdict"] == "undecided");
  CHECK_THAT(bench.run("--radius 0.5 --error-scan 0.1").err,
             Contains("so that no point outside the vehicle is certainly too close"));
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
  put_bytes(bench.folder / "box.off", off);
  bench.scan(wall(0.05, 10) + "5 0 0\n");  // 0.949 to 0.95 m deep
  const auto judged = [&](const std::string& error) {
    const Outcome outcome = bench.run("--radius 0.1 --model-as solid --json --error-model " + error,
                                      "out.h5", "box.off");
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
    return json::parse(outcome.out);
  };
  CHECK(judged("0.05")["verdict"] == "conflict");  // a radius above 0
  CHECK(judged("0.5")["verdict"] == "conflict");
  CHECK(judged("1.04")["verdict"] == "conflict");
  const json deep = judged("1.06");
  CHECK(deep["verdict"] == "undecided");
  CHECK(deep["certain_points"] == 0);
  CHECK(reasons_of(deep) == Words{"near"});
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
  REQUIRE(bench.run(query, "whole.h5").exit_code == 0);
  std::string parts;
  for (const char* part : {"1", "2", "3"}) {
    const std::string name = std::string("part") + part + ".h5";
    const Outcome outcome = bench.run(query + "--json --shard " + part + "/3", name);
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
    const json report = json::parse(outcome.out);
    CHECK((report["verdict"] == "unknown" || report["verdict"] == "conflict"));
    CHECK(reasons_of(report).empty());
    parts += name + " ";
  }
  const Outcome merged = bench.program("merge " + parts + "-o merged.h5 --json");
  INFO(merged.err);
  REQUIRE(merged.exit_code == 0);
  const json whole = json::parse(bench.program("info --json whole.h5").out);
  CHECK(whole["version"] == 6);
  CHECK(whole["near_points"].get<int>() > 0);
  CHECK(whole["certain_points"].get<int>() > 0);
  CHECK(json::parse(merged.out)["verdict"] == whole["verdict"]);
  CHECK(json::parse(merged.out)["near_points"] == whole["near_points"]);
  CHECK(bytes_of(bench.folder / "merged.h5") == bytes_of(bench.folder / "whole.h5"));
  CHECK(bench.program("verify whole.h5").exit_code == 0);
  CHECK(bench.program("compare whole.h5 merged.h5").exit_code == 0);

  const Outcome again = bench.program(
      "run --env site.h5 --model car.xyz --trajectory path.txt "
      "-o whole.h5 --resume --json " +
      query);
  INFO(again.err);
  REQUIRE(again.exit_code == 0);
  CHECK(json::parse(again.out)["was_finished"] == true);
  CHECK(json::parse(again.out)["verdict"] == whole["verdict"]);
  CHECK(json::parse(again.out)["margins"] == whole["margins"]);
}

TEST_CASE("every engine gives the bytes of an error budget") {
  const Bench bench;
  bench.scan(wall(0.4, 12) + wall(0.55, 30) + "5 0 0\n");
  const std::string query = "--radius 0.5 --error-model 0.08 --first-pose ";
  REQUIRE(bench.run(query + "--engine sweep", "whole.h5").exit_code == 0);
  CHECK(json::parse(bench.program("info --json whole.h5").out)["near_points"] == 30);
  for (const char* engine : {"kdtree", "grid"}) {
    CAPTURE(engine);
    REQUIRE(bench.run(query + "--engine " + engine, "out.h5").exit_code == 0);
    CHECK(bytes_of(bench.folder / "out.h5") == bytes_of(bench.folder / "whole.h5"));
  }
}

TEST_CASE("an error of 0 is a budget, and leaves the colliding points as they are") {
  const Bench bench;
  bench.scan(wall(0.4, 12) + "5 0 0\n");
  REQUIRE(bench.run("--radius 0.5 --first-pose", "whole.h5").exit_code == 0);
  const json report = bench.answer("--radius 0.5 --first-pose --error-scan 0");
  CHECK(report["verdict"] == "conflict");
  CHECK(report["margins"]["conflict"].get<double>() == Approx(std::sqrt(3e-6) / 2));
  const json a = json::parse(bench.program("info --json whole.h5").out);
  const json b = json::parse(bench.program("info --json out.h5").out);
  CHECK(a["colliding_points"] == b["colliding_points"]);
}

TEST_CASE("conflicts are certain or possible, and near points are listed as possible") {
  const Bench bench;
  bench.scan(wall(0.4, 12) + wall(-0.55, 12) + "5 0 0\n");
  const json report = bench.answer("--radius 0.5 --error-model 0.08 --first-pose");
  CHECK(report["near_points"] == 12);
  REQUIRE(bench.program("conflicts out.h5 --trajectory path.txt -o out.csv --force").exit_code ==
          0);
  std::ifstream file(bench.folder / "out.csv");
  std::string line, all;
  while (std::getline(file, line)) all += line + "\n";
  CHECK_THAT(all, Contains("class"));
  CHECK_THAT(all, Contains("certain"));
  CHECK_THAT(all, Contains("possible"));
}

TEST_CASE("errors that are none, and what a budget cannot be combined with, are refused") {
  const Bench bench;
  bench.scan("0.4 0 0\n5 0 0\n");
  for (const char* wrong : {"--error-scan=-0.1", "--error-scan nan", "--error-pose inf",
                            "--error-angle=-1", "--error-angle nan", "--sigmas 2", "--gap 0.2",
                            "--error-scan 0.01 --sigmas=-1", "--error-scan 0.01 --sigmas nan"}) {
    CAPTURE(wrong);
    CHECK(bench.run(std::string("--radius 0.1 ") + wrong).exit_code == 2);
  }
  const json degrees = bench.answer("--radius 0.1 --error-angle 1deg");
  CHECK(degrees["verdict"] == "clear");
}

TEST_CASE("near points are compared and exported as colliding ones are") {
  const Bench bench;
  bench.scan(wall(0.4, 12) + "0.56 0 0\n0.58 0.01 0\n0.7 0 0\n5 0 0\n");
  REQUIRE(bench.run("--radius 0.5 --first-pose --error-model 0.1", "out.h5").exit_code == 0);
  REQUIRE(bench.run("--radius 0.5 --first-pose --error-model 0.1", "whole.h5").exit_code == 0);
  const Outcome same = bench.program("compare out.h5 whole.h5 --json");
  CHECK(same.exit_code == 0);
  CHECK(json::parse(same.out)["near"] == json{{"in_a", 2},
                                              {"in_b", 2},
                                              {"common", 2},
                                              {"only_in_a", 0},
                                              {"only_in_b", 0},
                                              {"differing", 0}});
  REQUIRE(bench.run("--radius 0.5 --first-pose --error-model 0.3", "whole.h5").exit_code == 0);
  const Outcome other = bench.program("compare out.h5 whole.h5");
  CHECK(other.exit_code == 1);
  CHECK_THAT(other.out, Contains("near points in both: 2, only in a: 0, only in b: 1") &&
                            Contains("only in a: 0\nonly in b: 0\n") && Contains("different"));
  REQUIRE(bench.program("export out.h5 --what near -o out.csv --force").exit_code == 0);
  CHECK(bytes_of(bench.folder / "out.csv") ==
        "source,x,y,z,first_pose\n12,0.56,0,0,0\n13,0.58,0.01,0,0\n");
  REQUIRE(bench.run("--radius 0.5 --first-pose", "whole.h5").exit_code == 0);
  const Outcome without = bench.program("compare out.h5 whole.h5 --json");
  CHECK(without.exit_code == 0);
  CHECK_FALSE(json::parse(without.out).contains("near"));
  const Outcome refused = bench.program("export whole.h5 --what near -o out.csv --force");
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, Contains("had no error budget"));
}

TEST_CASE("without --gap points hang together within 0.3 m, also in feet") {
  const Bench bench;
  // Points 0.5 units apart are within 0.3 m of their neighbours in feet, and not in metres.
  bench.scan(wall(0.1, 12, 0.5), "0.001", "--unit ift");
  CHECK(bench.answer("--radius 30 --error-model 0.01")["verdict"] == "conflict");
  const json info = json::parse(bench.program("info --json out.h5").out);
  CHECK(info["gap"].get<double>() == Approx(0.3 / 0.3048));
  CHECK(bench.answer("--radius 30 --error-model 0.01 --gap 0.3")["verdict"] == "undecided");
  bench.scan(wall(0.1, 12, 0.5));
  CHECK(bench.answer("--radius 30 --error-model 0.01")["verdict"] == "undecided");
  CHECK(json::parse(bench.program("info --json out.h5").out)["gap"] == 0.3);
  const Outcome none = bench.run("--radius 30 --error-model 0.01 --gap 0");
  CHECK(none.exit_code == 2);
  CHECK_THAT(none.err, Contains("--gap"));
}
