// clearway shift, and report --shifts, through the built program.
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/catch.hpp"
#include "tools/cli/conflicts/yard.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;

namespace {

/// A folder with a box of 2 x 1 x 1 m that drives 12 m along x past two walls: the first reaches
/// 0.1 m into its way from the left, the second 0.2 m from the right.
struct Lane : Workplace {
  Lane() {
    std::string scan;
    for (int i = 0; i <= 10; ++i) {
      for (int k = 0; k <= 4; ++k) {
        const std::string height = " " + std::to_string(0.1 + 0.2 * k) + "\n";
        scan += std::to_string(3 + 0.1 * i) + " 0.4" + height;
        scan += std::to_string(8 + 0.1 * i) + " -0.3" + height;
      }
    }
    put("scan.xyz", scan);
    put("path.txt", path_along_x(25, 0.5));
    succeed("convert scan.xyz -o site.h5");
    succeed("model box 2,1,1 -o box.off");
    succeed("run --model-as solid --radius 0.001 --first-pose --clearance 0.3 -o out.h5" + files());
  }

  std::string files(const std::string& model = "box.off") const {
    return " --env site.h5 --model " + model + " --trajectory path.txt";
  }
  Outcome shift(const std::string& options, const std::string& result = "out.h5") const {
    return run("shift " + result + files() + " " + options);
  }
  json shifts(const std::string& options, const std::string& result = "out.h5") const {
    return json_of(require_success(shift("--json " + options, result)));
  }
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
  const Outcome table =
      require_success(lane().shift("--lateral -2,2 --step 0.01 --force -o s.json -o s.csv"));
  check_says(
      table.out,
      "the whole path: 0.81 m to the right frees it ... 2 conflicts, of which 2 can be freed by a "
      "shift of up to 2 m ... 0.11 m to the right frees it ... 0.21 m to the left frees it");
  check_says(table.err, "what was not scanned counts as free");

  const std::string text = lane().bytes("s.json");
  const json all = json::parse(text);
  CHECK(lane().shift("--json").out == text);  // these are the defaults
  CHECK(lane().shift("--json --threads 1 --device cpu").out == text);
  check_json(all, R"({
    "kind": "shifts", "unit": "m", "lateral_from": -2, "lateral_to": 2, "step": 0.01,
    "path": {"conflict": 0, "shift": -0.81, "side": "right", "chainage_to": 12,
    "station_from": null}})");
  REQUIRE(all["conflicts"].size() == 2);
  check_json(all, R"({
    "conflicts": {"0": {"shift": -0.11, "side": "right"}, "1": {"shift": 0.21}}})");
  check_near(all, "/conflicts/0/least_distance", 0.01);
  // The box is 2 m long, and the wall 1 m.
  check_json(all, R"({
    "conflicts": {"0": {"chainage_from": 2, "chainage_to": 5, "first_pose": 4, "last_pose": 10}}})");
  const std::uint64_t of_conflicts = all["conflicts"][0]["searches"].get<std::uint64_t>() +
                                     all["conflicts"][1]["searches"].get<std::uint64_t>();
  CHECK(all["searches"] == of_conflicts + all["path"]["searches"].get<std::uint64_t>());
  CHECK(of_conflicts < 20);

  const auto rows = csv_rows(lane().bytes("s.csv"));
  REQUIRE(rows.size() == 4);
  CHECK(rows[0] ==
        "conflict,chainage_from,chainage_to,station_from,station_to,first_pose,last_pose,shift,"
        "side,least_distance,searches,warned_of");
  CHECK_THAT(rows[1], StartsWith("0,0,12,,,0,24,-0.81,right,"));
  CHECK_THAT(rows[2], StartsWith("1,2,5,,,4,10,-0.11,right,0.0"));
}

TEST_CASE("shift looks only where it is told, and says if nothing is found") {
  check_json(lane().shifts("--lateral -0.3,0 --step 10cm"), R"({
    "conflicts": {"0": {"shift": -0.2}, "1": {"shift": null, "side": null}},
    "path": {"shift": null}})");
  check_outcome(lane().shift("--lateral=-0.05,0.05 --step 1cm --show 1"), 0, kAnything,
                "the whole path: no shift of up to 0.05 m frees it ... of which 0 can be freed ... "
                "and 1 conflict more, which --show or an output shows");
  check_says(lane().shift("--min-points 1000").out,
             "the whole path: 0.81 m to the right frees it ... 2 groups of fewer than 1,000 points "
             "are no conflict, and count for the whole path alone; --min-points 1 lists them");
  check_says(lane().shift("--lateral=-0.05,0.1").out,
             "no shift between 0.05 m to the right and 0.1 m to the left frees it");
}

TEST_CASE("where the question is in doubt, no shift is known to free anything") {
  const Lane own;
  own.put("path.txt", own.bytes("path.txt") + "1 0 0 12.5 0 1 0 0 0 0 1 0.");
  own.succeed("run --model-as solid --radius 0.001 --first-pose --force -o out.h5" + own.files());
  check_says(own.shift("").out,
             "the whole path: no shift of up to 2 m is known to free it, because the question is "
             "in doubt (cut-text), so what stands in the way may not have been found");
  check_json(own.shifts(""), R"({"path": {"shift": null, "warned_of": ["cut-text"]},
    "conflicts": {"0": {"shift": null, "searches": 0}}})");
}

TEST_CASE("a path on which nothing collides needs no shift") {
  std::string scan;
  for (int i = 0; i < 120; ++i) {
    scan += std::to_string(0.1 * i) + " 2 " + std::to_string(0.1 * (i % 7)) + "\n";
  }
  lane().put("beside.xyz", scan);
  lane().succeed("convert beside.xyz --force -o beside.h5");
  const std::string files = " --env beside.h5 --model box.off --trajectory path.txt";
  lane().succeed("run --model-as solid --radius 0.001 --first-pose --force -o free.h5" + files);
  check_json(lane().answer("shift free.h5 --json" + files),
             R"({"path": {"shift": 0, "side": null}, "conflicts": []})");
  check_says(lane().run("shift free.h5" + files).out, "the whole path: it is free");
}

TEST_CASE("points that the run ignored stay ignored, and an error budget keeps its distance") {
  lane().succeed(
      "run --model-as solid --radius 0.001 --first-pose --ignore-box=0,-9,0,6,9,9 --force -o "
      "ignored.h5" +
      lane().files());
  const json ignored = lane().shifts("", "ignored.h5");
  REQUIRE(ignored["conflicts"].size() == 1);
  check_json(ignored, R"({"path": {"shift": 0.21}})");
  lane().succeed(
      "run --model-as solid --radius 0.1 --error-model 0.05 --first-pose --force -o budget.h5" +
      lane().files());
  // 0.1 m to be free, 0.05 m of error, half a step of the stored coordinates, and half the way of
  // 0.5 m from a pose to the next.
  check_json(lane().shifts("", "budget.h5"),
             R"({"conflicts": {"0": {"shift": -0.51}, "1": {"shift": 0.61}}})");
}

TEST_CASE("a model that its run turned is shifted to its own side") {
  lane().succeed("model box 1,2,1 -o across.off");
  lane().succeed(
      "run --model-as solid --radius 0.001 --first-pose --clearance 0.3 --forward +y --force -o "
      "turned.h5" +
      lane().files("across.off"));
  const std::string again = "shift turned.h5" + lane().files("across.off") + " --json";
  const json turned = json_of(lane().succeed(again));
  check_json(turned, R"({"path": {"shift": -0.81}, "conflicts": {"0": {"shift": -0.11}}})");
  check_refused(lane().run(again + " --forward +y"), 2, "its run turned the model");
}

TEST_CASE("shift refuses what it cannot answer, and leaves no output") {
  const std::string out = " -o no.csv";
  check_cases([&](const std::string& more) { return lane().shift(more); },
              {
                  {"--lateral 2" + out, 2, "--lateral"},
                  {"--lateral left,right" + out, 2, "--lateral"},
                  {"--lateral 0.1,2" + out, 2, "expected a range that contains 0"},
                  {"--lateral 2,-2" + out, 2, "expected a range that contains 0"},
                  {"--step 0" + out, 2, "--step"},
                  {"--step=-0.01" + out, 2, "--step"},
                  {"--step 1e-9" + out, 2, "more than 1,000,000"},
                  {"--gap 0" + out, 2, "--gap"},
                  {"-o no.xml", 2, "must end in .csv or .json"},
              });
  check_refused(lane().run("shift out.h5 --model box.off --trajectory path.txt"), 2, "--env");
  check_refused(lane().run("shift out.h5 --env site.h5 --trajectory path.txt"), 2, "--model");
  check_refused(lane().shift("--force -o out.h5.json --vehicle box.off"), 2, "--vehicle");

  lane().succeed("run --model-as solid --radius 0.001 --force -o set.h5" + lane().files());
  check_refused(lane().shift(out, "set.h5"), 2, "makes a result with first poses");
  lane().succeed("run --model-as solid --radius 0.001 --first-pose --shard 1/2 --force -o part.h5" +
                 lane().files());
  check_refused(lane().shift(out, "part.h5"), 3, "part");
  lane().succeed("model box 2,1.2,1 -o wide.off --force");
  check_refused(lane().run("shift out.h5" + lane().files("wide.off") + out), 3,
                "is not the model of");
  lane().put("other.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  check_refused(
      lane().run("shift out.h5 --env site.h5 --model box.off --trajectory other.txt" + out), 3,
      "another trajectory");
  lane().put("other.xyz", "1 2 3\n4 5 6\n");
  lane().succeed("convert other.xyz --force -o other.h5");
  check_refused(
      lane().run("shift out.h5 --env other.h5 --model box.off --trajectory path.txt" + out), 3,
      "another environment");
  for (const char* file : {"no.csv", "no.csv.partial", "no.xml"}) {
    CHECK_FALSE(lane().has(file));
  }
  lane().put("kept.csv", "mine");
  check_refused(lane().shift("-o kept.csv"), 2, "--force");
  check_same(lane().bytes("kept.csv"), "mine");
}

TEST_CASE(
    "the bodies of a vehicle are shifted along the y axis of the path, whichever way they look") {
  const std::string files = " --env site.h5 --vehicle wagon.json --trajectory path.txt";
  for (const char* motion : {"", " --between-poses"}) {
    CAPTURE(motion);
    yard().succeed("run --radius 0.15 --first-pose --force -o shifted.h5" + files + motion);
    const json shifts = yard().answer("shift shifted.h5" + files + " --json --step 0.02");
    REQUIRE(shifts["conflicts"].size() == 2);
    // The models are points at their corners, so that at 0.26 m the point is between two of them.
    check_json(shifts, R"({
      "conflicts": {"0": {"shift": 0.06}, "1": {"shift": -0.06}}, "path": {"shift": 0.26},
      "bodies": ["truck", "crane"]})");
  }
  check_refused(yard().run("shift shifted.h5 --env site.h5 --model box.xyz --trajectory path.txt"),
                3, "give it with --vehicle");
}

TEST_CASE("shifts of a scan in feet are in feet, and lengths with units are converted") {
  const Workplace place;
  std::string scan = "x[ft],y[ft],z[ft]\n", path = "x[ft],y[ft],z[ft],qx,qy,qz,qw\n";
  for (int i = 0; i < 40; ++i) {
    scan += std::to_string(10 + 0.05 * i) + ",0.4," + std::to_string(0.02 * i) + "\n";
    path += std::to_string(0.5 * i) + ",0,0,0,0,0,1\n";
  }
  place.put("scan.csv", scan);
  place.put("path.csv", path);
  place.put("model.xyz", "0 0.5 0\n0 0 0\n0 -0.5 0\n");
  place.succeed("convert scan.csv -o site.h5 --unit ft");
  const std::string files = " --env site.h5 --model model.xyz --trajectory path.csv";
  place.succeed("run --model-unit ft --radius 0.3 --first-pose -o out.h5" + files);
  const std::string shift = "shift out.h5" + files + " --model-unit ft --json ";
  const Outcome feet = place.succeed(shift + "--step 0.25 --lateral -1,1");
  check_json(json_of(feet), R"({"unit": "ft", "path": {"shift": -0.5}})");
  CHECK(place.succeed(shift + "--step 3in --lateral=-12in,1ft").out == feet.out);
}

TEST_CASE("the report tells the shifts of its own result alone") {
  const std::string shifts = "for_report.json", page = "page.html";
  require_success(lane().shift("--force -o " + shifts));
  const std::string report = "report out.h5" + lane().files() + " --json --force -o " + page;
  const json plain = json_of(lane().succeed(report));
  CHECK_FALSE(plain.contains("shifts"));
  const json told = json_of(lane().succeed(report + " --shifts " + shifts))["shifts"];
  check_json(told, R"({"lateral_to": 2, "step": 0.01, "path": {"shift": -0.81}})");
  REQUIRE(told["list"].size() == 2);
  check_json(told, R"({"list": {"0": {"conflict": 1, "shift": -0.11}}})");

  check_refused(lane().run(report + " --min-points 1000 --shifts " + shifts), 3,
                "are not those of the table of shifts");
  check_refused(lane().run("report out.h5" + lane().files() + " -o " + shifts +
                           " --force --shifts " + shifts),
                2, "is an input too");
  lane().succeed(
      "run --model-as solid --radius 0.002 --first-pose --clearance 0.3 --force -o near.h5" +
      lane().files());
  check_refused(
      lane().run("report near.h5" + lane().files() + " --force -o " + page + " --shifts " + shifts),
      3, "holds the shifts of another result");
  const auto broken = [&](const std::string& text, const std::string& message) {
    lane().put("broken.json", text);
    check_refused(lane().run(report + " --shifts broken.json"), 3, message);
  };
  broken("", "is no JSON");
  broken("[]", "expected one JSON object");
  broken("{}", "is no table of shifts");
  broken(R"({"kind": "conflicts"})", "is no table of shifts");
  broken(R"({"kind": "shifts"})", "question_hash: is missing");
  json changed = json::parse(lane().bytes("for_report.json"));
  changed["path"]["shift"] = "far";
  broken(changed.dump(), "path.shift: expected a number");
  changed["path"]["shift"] = nullptr;
  changed["conflicts"][1]["first_pose"] = -1;
  broken(changed.dump(), "conflicts[1].first_pose: expected a whole number");
  changed["conflicts"] = 3;
  broken(changed.dump(), "conflicts: expected a list");
}
