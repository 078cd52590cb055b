// clearway shift, and report --shifts, through the built program.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tools/cli/support/hall.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;
using nlohmann::json;

namespace {

/// A folder with a box of 2 x 1 x 1 m that drives 12 m along x past two walls: the first reaches
/// 0.1 m into its way from the left, the second 0.2 m from the right.
struct Lane {
  Lane() {
    std::string scan, path;
    for (int i = 0; i <= 10; ++i) {
      for (int k = 0; k <= 4; ++k) {
        const std::string height = " " + std::to_string(0.1 + 0.2 * k) + "\n";
        scan += std::to_string(3 + 0.1 * i) + " 0.4" + height;
        scan += std::to_string(8 + 0.1 * i) + " -0.3" + height;
      }
    }
    for (int i = 0; i <= 24; ++i) path += "1 0 0 " + std::to_string(0.5 * i) + " 0 1 0 0 0 0 1 0\n";
    put_bytes(folder / "scan.xyz", scan);
    put_bytes(folder / "path.txt", path);
    done("convert " + name("scan.xyz") + " -o " + name("site.h5"));
    done("model box 2,1,1 -o " + name("box.off"));
    done("run --model-as solid --radius 0.001 --first-pose --clearance 0.3 -o " + name("out.h5") +
         files());
  }

  std::string name(const std::string& file) const { return quoted(folder / file); }
  std::string files(const std::string& model = "box.off") const {
    return " --env " + name("site.h5") + " --model " + name(model) + " --trajectory " +
           name("path.txt");
  }
  Outcome run(const std::string& arguments) const { return run_program(folder, arguments); }
  Outcome done(const std::string& arguments) const {
    Outcome outcome = run(arguments);
    CAPTURE(arguments, outcome.err);
    REQUIRE(outcome.exit_code == 0);
    return outcome;
  }
  Outcome shift(const std::string& options, const std::string& result = "out.h5") const {
    return run("shift " + name(result) + files() + " " + options);
  }
  json shifts(const std::string& options, const std::string& result = "out.h5") const {
    const Outcome outcome = shift("--json " + options, result);
    CAPTURE(outcome.err);
    REQUIRE(outcome.exit_code == 0);
    return json::parse(outcome.out);
  }

  ScratchFolder folder;
};

const Lane& lane() {
  static const Lane made;
  return made;
}

std::vector<std::string> csv_rows(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

}  // namespace

TEST_CASE("shift says what frees the path and each conflict, as a table, in JSON and in CSV") {
  const Outcome table = lane().shift("--lateral -2,2 --step 0.01 --force -o " +
                                     lane().name("s.json") + " -o " + lane().name("s.csv"));
  CAPTURE(table.err);
  REQUIRE(table.exit_code == 0);
  CHECK_THAT(table.out, Contains("2 conflicts, of which 2 can be freed by a shift of up to 2 m") &&
                            Contains("0.11 m to the right frees it") &&
                            Contains("0.21 m to the left frees it") &&
                            Contains("the whole path: 0.81 m to the right frees it"));
  CHECK_THAT(table.err, Contains("what was not scanned counts as free"));

  const std::string text = bytes_of(lane().folder / "s.json");
  const json all = json::parse(text);
  CHECK(lane().shift("--json").out == text);  // these are the defaults
  CHECK(lane().shift("--json --threads 1 --device cpu").out == text);
  CHECK(all["kind"] == "shifts");
  CHECK(all["unit"] == "m");
  CHECK(all["lateral_from"] == -2);
  CHECK(all["lateral_to"] == 2);
  CHECK(all["step"] == 0.01);
  CHECK(all["path"]["conflict"] == 0);
  CHECK(all["path"]["shift"] == -0.81);
  CHECK(all["path"]["side"] == "right");
  CHECK(all["path"]["chainage_to"] == 12);
  CHECK(all["path"]["station_from"].is_null());
  REQUIRE(all["conflicts"].size() == 2);
  CHECK(all["conflicts"][0]["shift"] == -0.11);
  CHECK(all["conflicts"][0]["side"] == "right");
  CHECK(all["conflicts"][0]["least_distance"].get<double>() == Approx(0.01));
  CHECK(all["conflicts"][1]["shift"] == 0.21);
  // The box is 2 m long, and the wall 1 m.
  CHECK(all["conflicts"][0]["chainage_from"] == 2);
  CHECK(all["conflicts"][0]["chainage_to"] == 5);
  CHECK(all["conflicts"][0]["first_pose"] == 4);
  CHECK(all["conflicts"][0]["last_pose"] == 10);
  const std::uint64_t of_conflicts = all["conflicts"][0]["searches"].get<std::uint64_t>() +
                                     all["conflicts"][1]["searches"].get<std::uint64_t>();
  CHECK(all["searches"] == of_conflicts + all["path"]["searches"].get<std::uint64_t>());
  CHECK(of_conflicts < 20);

  const auto rows = csv_rows(bytes_of(lane().folder / "s.csv"));
  REQUIRE(rows.size() == 4);
  CHECK(rows[0] ==
        "conflict,chainage_from,chainage_to,station_from,station_to,first_pose,last_pose,shift,"
        "side,least_distance,searches,warned_of");
  CHECK_THAT(rows[1], Catch::StartsWith("0,0,12,,,0,24,-0.81,right,"));
  CHECK_THAT(rows[2], Catch::StartsWith("1,2,5,,,4,10,-0.11,right,0.0"));
}

TEST_CASE("shift looks only where it is told, and says if nothing is found") {
  const json few = lane().shifts("--lateral -0.3,0 --step 10cm");
  CHECK(few["conflicts"][0]["shift"] == -0.2);
  CHECK(few["conflicts"][1]["shift"].is_null());
  CHECK(few["conflicts"][1]["side"].is_null());
  CHECK(few["path"]["shift"].is_null());
  const Outcome none = lane().shift("--lateral=-0.05,0.05 --step 1cm --show 1");
  CHECK(none.exit_code == 0);
  CHECK_THAT(none.out, Contains("the whole path: no shift of up to 0.05 m frees it") &&
                           Contains("of which 0 can be freed") &&
                           Contains("and 1 conflict more, which --show or an output shows"));
  CHECK_THAT(lane().shift("--min-points 1000").out,
             Contains("2 groups of fewer than 1,000 points are no conflict, and count for the "
                      "whole path alone; --min-points 1 lists them") &&
                 Contains("the whole path: 0.81 m to the right frees it"));
  CHECK_THAT(lane().shift("--lateral=-0.05,0.1").out,
             Contains("no shift between 0.05 m to the right and 0.1 m to the left frees it"));
}

TEST_CASE("a path on which nothing collides needs no shift") {
  lane().done(
      "run --model-as solid --radius 0.001 --first-pose --ignore-box=0,-9,0,20,9,9 --force "
      "-o " +
      lane().name("free.h5") + lane().files());
  const json free = lane().shifts("", "free.h5");
  CHECK(free["path"]["shift"] == 0);
  CHECK(free["path"]["side"].is_null());
  CHECK(free["conflicts"].empty());
  CHECK_THAT(lane().shift("", "free.h5").out, Contains("the whole path: it is free"));
}

TEST_CASE("points that the run ignored stay ignored, and an error budget keeps its distance") {
  lane().done(
      "run --model-as solid --radius 0.001 --first-pose --ignore-box=0,-9,0,6,9,9 --force -o " +
      lane().name("ignored.h5") + lane().files());
  const json ignored = lane().shifts("", "ignored.h5");
  REQUIRE(ignored["conflicts"].size() == 1);
  CHECK(ignored["path"]["shift"] == 0.21);
  lane().done("run --model-as solid --radius 0.1 --error-model 0.05 --first-pose --force -o " +
              lane().name("budget.h5") + lane().files());
  // 0.1 m to be free, 0.05 m of error, half a step of the stored coordinates, and half the way of
  // 0.5 m from a pose to the next.
  const json budget = lane().shifts("", "budget.h5");
  CHECK(budget["conflicts"][0]["shift"] == -0.51);
  CHECK(budget["conflicts"][1]["shift"] == 0.61);
}

TEST_CASE("a model that its run turned is shifted to its own side") {
  lane().done("model box 1,2,1 -o " + lane().name("across.off"));
  lane().done(
      "run --model-as solid --radius 0.001 --first-pose --clearance 0.3 --forward +y --force "
      "-o " +
      lane().name("turned.h5") + lane().files("across.off"));
  const std::string again =
      "shift " + lane().name("turned.h5") + lane().files("across.off") + " --json";
  const json turned = json::parse(lane().done(again).out);
  CHECK(turned["path"]["shift"] == -0.81);
  CHECK(turned["conflicts"][0]["shift"] == -0.11);
  check_refused(lane().run(again + " --forward +y"), 2, "its run turned the model");
}

TEST_CASE("shift refuses what it cannot answer, and leaves no output") {
  const std::string out = " -o " + lane().name("no.csv");
  check_refused(lane().shift("--lateral 2" + out), 2, "--lateral");
  check_refused(lane().shift("--lateral left,right" + out), 2, "--lateral");
  check_refused(lane().shift("--lateral 0.1,2" + out), 2, "expected a range that contains 0");
  check_refused(lane().shift("--lateral 2,-2" + out), 2, "expected a range that contains 0");
  check_refused(lane().shift("--step 0" + out), 2, "--step");
  check_refused(lane().shift("--step=-0.01" + out), 2, "--step");
  check_refused(lane().shift("--step 1e-9" + out), 2, "more than 1,000,000");
  check_refused(lane().shift("--gap 0" + out), 2, "--gap");
  check_refused(lane().shift("-o " + lane().name("no.xml")), 2, "must end in .csv or .json");
  check_refused(lane().run("shift " + lane().name("out.h5") + " --model " + lane().name("box.off") +
                           " --trajectory " + lane().name("path.txt")),
                2, "--env");
  check_refused(lane().run("shift " + lane().name("out.h5") + " --env " + lane().name("site.h5") +
                           " --trajectory " + lane().name("path.txt")),
                2, "--model");
  check_refused(lane().shift("--force -o " + lane().name("out.h5") + ".json --vehicle " +
                             lane().name("box.off")),
                2, "--vehicle");

  lane().done("run --model-as solid --radius 0.001 --force -o " + lane().name("set.h5") +
              lane().files());
  check_refused(lane().shift(out, "set.h5"), 2, "makes a result with first poses");
  lane().done("run --model-as solid --radius 0.001 --first-pose --shard 1/2 --force -o " +
              lane().name("part.h5") + lane().files());
  check_refused(lane().shift(out, "part.h5"), 3, "part");
  lane().done("model box 2,1.2,1 -o " + lane().name("wide.off") + " --force");
  check_refused(lane().run("shift " + lane().name("out.h5") + lane().files("wide.off") + out), 3,
                "is not the model of");
  put_bytes(lane().folder / "other.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  check_refused(lane().run("shift " + lane().name("out.h5") + " --env " + lane().name("site.h5") +
                           " --model " + lane().name("box.off") + " --trajectory " +
                           lane().name("other.txt") + out),
                3, "another trajectory");
  put_bytes(lane().folder / "other.xyz", "1 2 3\n4 5 6\n");
  lane().done("convert " + lane().name("other.xyz") + " --force -o " + lane().name("other.h5"));
  check_refused(lane().run("shift " + lane().name("out.h5") + " --env " + lane().name("other.h5") +
                           " --model " + lane().name("box.off") + " --trajectory " +
                           lane().name("path.txt") + out),
                3, "another environment");
  for (const char* file : {"no.csv", "no.csv.partial", "no.xml"}) {
    CHECK_FALSE(std::filesystem::exists(lane().folder / file));
  }
  put_bytes(lane().folder / "kept.csv", "mine");
  check_refused(lane().shift("-o " + lane().name("kept.csv")), 2, "--force");
  CHECK(bytes_of(lane().folder / "kept.csv") == "mine");
}

TEST_CASE(
    "the bodies of a vehicle are shifted along the y axis of the path, whichever way they look") {
  // Ten points stand 0.3 m to the right of a truck and of a crane that looks backwards, 10 m to the
  // left of the truck's path; the crane's right is the path's left.
  const ScratchFolder folder;
  const auto name = [&](const std::string& file) { return quoted(folder / file); };
  const auto run = [&](const std::string& arguments) {
    Outcome outcome = run_program(folder, arguments);
    CAPTURE(arguments, outcome.err);
    REQUIRE(outcome.exit_code == 0);
    return outcome;
  };
  std::string scan, box, path, crane;
  for (int i = 0; i < 10; ++i) {
    const std::string rest = " " + std::to_string(0.3 + i * 0.05) + "\n";
    scan += "5 -0.3" + rest + "8 10.3" + rest;
  }
  for (const char* corner : {"-0.5 -0.2", "-0.5 0.2", "0.5 -0.2", "0.5 0.2"}) {
    for (int k = 0; k <= 10; ++k) box += std::string(corner) + " " + std::to_string(k * 0.1) + "\n";
  }
  for (int i = 0; i <= 100; ++i) {
    const std::string x = std::to_string(i * 0.1);
    path += "1 0 0 " + x + " 0 1 0 0 0 0 1 0\n";
    crane += "-1 0 0 " + x + " 0 -1 0 10 0 0 1 0\n";
  }
  put_bytes(folder / "scan.xyz", scan);
  put_bytes(folder / "box.xyz", box);
  put_bytes(folder / "path.txt", path);
  put_bytes(folder / "crane.txt", crane);
  put_bytes(folder / "yard.json", R"({"bodies": [{"name": "truck", "model": "box.xyz"},
      {"name": "crane", "model": "box.xyz", "trajectory": "crane.txt"}]})");
  run("convert " + name("scan.xyz") + " -o " + name("site.h5"));
  const std::string files = " --env " + name("site.h5") + " --vehicle " + name("yard.json") +
                            " --trajectory " + name("path.txt");
  for (const char* motion : {"", " --between-poses"}) {
    CAPTURE(motion);
    run("run --radius 0.15 --first-pose --force -o " + name("out.h5") + files + motion);
    const json shifts =
        json::parse(run("shift " + name("out.h5") + files + " --json --step 0.02").out);
    REQUIRE(shifts["conflicts"].size() == 2);
    CHECK(shifts["conflicts"][0]["shift"] == 0.06);
    CHECK(shifts["conflicts"][1]["shift"] == -0.06);
    // The models are points at their corners, so that at 0.26 m the point is between two of them.
    CHECK(shifts["path"]["shift"] == 0.26);
    CHECK(shifts["bodies"] == json({"truck", "crane"}));
  }
  check_refused(
      run_program(folder, "shift " + name("out.h5") + " --env " + name("site.h5") + " --model " +
                              name("box.xyz") + " --trajectory " + name("path.txt")),
      3, "give it with --vehicle");
}

TEST_CASE("shifts of a scan in feet are in feet, and lengths with units are converted") {
  const ScratchFolder folder;
  const auto name = [&](const std::string& file) { return quoted(folder / file); };
  std::string scan = "x[ft],y[ft],z[ft]\n", path = "x[ft],y[ft],z[ft],qx,qy,qz,qw\n";
  for (int i = 0; i < 40; ++i) {
    scan += std::to_string(10 + 0.05 * i) + ",0.4," + std::to_string(0.02 * i) + "\n";
    path += std::to_string(0.5 * i) + ",0,0,0,0,0,1\n";
  }
  put_bytes(folder / "scan.csv", scan);
  put_bytes(folder / "path.csv", path);
  put_bytes(folder / "model.xyz", "0 0.5 0\n0 0 0\n0 -0.5 0\n");
  const auto run = [&](const std::string& arguments) {
    Outcome outcome = run_program(folder, arguments);
    CAPTURE(arguments, outcome.err);
    REQUIRE(outcome.exit_code == 0);
    return outcome;
  };
  run("convert " + name("scan.csv") + " -o " + name("site.h5") + " --unit ft");
  const std::string files = " --env " + name("site.h5") + " --model " + name("model.xyz") +
                            " --trajectory " + name("path.csv");
  run("run --model-unit ft --radius 0.3 --first-pose -o " + name("out.h5") + files);
  const std::string shift = "shift " + name("out.h5") + files + " --model-unit ft --json ";
  const Outcome feet = run(shift + "--step 0.25 --lateral -1,1");
  const json all = json::parse(feet.out);
  CHECK(all["unit"] == "ft");
  CHECK(all["path"]["shift"] == -0.5);
  CHECK(run(shift + "--step 3in --lateral=-12in,1ft").out == feet.out);
}

TEST_CASE("the report tells the shifts of its own result alone") {
  const std::string shifts = lane().name("for_report.json"), page = lane().name("page.html");
  REQUIRE(lane().shift("--force -o " + shifts).exit_code == 0);
  const std::string report =
      "report " + lane().name("out.h5") + lane().files() + " --json --force -o " + page;
  const json plain = json::parse(lane().done(report).out);
  CHECK_FALSE(plain.contains("shifts"));
  const json told = json::parse(lane().done(report + " --shifts " + shifts).out)["shifts"];
  CHECK(told["lateral_to"] == 2);
  CHECK(told["step"] == 0.01);
  CHECK(told["path"]["shift"] == -0.81);
  REQUIRE(told["list"].size() == 2);
  CHECK(told["list"][0]["conflict"] == 1);
  CHECK(told["list"][0]["shift"] == -0.11);

  check_refused(lane().run(report + " --min-points 1000 --shifts " + shifts), 3,
                "are not those of the table of shifts");
  check_refused(lane().run("report " + lane().name("out.h5") + lane().files() + " -o " + shifts +
                           " --force --shifts " + shifts),
                2, "is an input too");
  lane().done("run --model-as solid --radius 0.002 --first-pose --clearance 0.3 --force -o " +
              lane().name("near.h5") + lane().files());
  check_refused(lane().run("report " + lane().name("near.h5") + lane().files() + " --force -o " +
                           page + " --shifts " + shifts),
                3, "holds the shifts of another result");
  const auto broken = [&](const std::string& text, const std::string& message) {
    put_bytes(lane().folder / "broken.json", text);
    check_refused(lane().run(report + " --shifts " + lane().name("broken.json")), 3, message);
  };
  broken("", "is no JSON");
  broken("[]", "expected one JSON object");
  broken("{}", "is no table of shifts");
  broken(R"({"kind": "conflicts"})", "is no table of shifts");
  broken(R"({"kind": "shifts"})", "question_hash: is missing");
  json changed = json::parse(bytes_of(lane().folder / "for_report.json"));
  changed["path"]["shift"] = "far";
  broken(changed.dump(), "path.shift: expected a number");
  changed["path"]["shift"] = nullptr;
  changed["conflicts"][1]["first_pose"] = -1;
  broken(changed.dump(), "conflicts[1].first_pose: expected a whole number");
  changed["conflicts"] = 3;
  broken(changed.dump(), "conflicts: expected a list");
}
