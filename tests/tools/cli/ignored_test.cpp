// Ignored classes and boxes as a user sees them.
#include <nlohmann/json.hpp>

#include "support/bytes/las_bytes.hpp"
#include "support/catch.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;

namespace {

/// A wall of class 6 beside a path along x, and a plant of class 3 in the way.
struct Garden : Workplace {
  Garden() {
    for (std::int32_t i = 0; i < 2000; ++i) add({i * 5, 1000, 0}, 6);
    for (std::int32_t i = 0; i < 40; ++i) add({7000 + i, 50, i}, 3);
    put("all.las", las.build());
    put("wall.xyz", "0 1 0\n1 1 0\n");
    put("car.xyz", "0 0 0\n0.01 0 0\n-0.01 0 0\n0 0.01 0\n0 -0.01 0\n");
    put("path.txt", path_along_x(101, 0.1));
    require_success(run("convert all.las -o site.h5 --cell-points 64"));
    require_success(run("convert wall.xyz -o wall.h5"));
  }

  void add(const std::array<std::int32_t, 3>& point, std::uint8_t point_class) {
    las.scale = {0.001, 0.001, 0.001};
    las.offset = {0, 0, 0};
    if (las.bytes_of_class.empty()) las.points.clear();
    las.points.push_back(point);
    las.bytes_of_class.push_back(point_class);
  }
  Outcome search(const std::string& arguments, const std::string& store = "site.h5") const {
    return run("run --env " + store +
               " --model car.xyz --trajectory path.txt --threads 2 --radius 0.1 " + arguments);
  }

  LasBytes las;
};

const std::string kPlant = "--ignore-class 3 ";
const std::string kPlantBox = "--ignore-box 6.9,0,-1,7.1,0.5,1 ";

}  // namespace

TEST_CASE("conflicts and export of a result repeat how many ignored points would collide") {
  const Garden garden;
  require_success(garden.search(kPlant + "--first-pose -o b.h5"));
  const std::string verdict =
      "the verdict of this result is clear with warnings, with 40 points ignored (class 3), 40 of "
      "which would collide: no other point is closer";
  check_says(garden.run("conflicts b.h5 --trajectory path.txt").out, verdict);
  const Outcome listed = garden.run("conflicts b.h5 --trajectory path.txt --json");
  check_json(json_of(listed), R"({"ignored_colliding": 40})");
  check_says(listed.err, verdict);
  const Outcome exported = garden.run("export b.h5 -o b.csv --json");
  check_says(exported.err, verdict);
  check_json(json_of(exported), R"({"ignored": {"colliding": 40}})");
}

TEST_CASE("a verdict says what lies below the floor, and so does every output") {
  const Garden garden;
  const Outcome searched = garden.search("--floor 0.01 --json -o b.h5");
  require_success(searched);
  const std::string verdict =
      "conflict, with 10 points within the radius below 0.01 m of the vehicle not judged: 30 "
      "points are closer";
  check_json(json_of(searched),
             R"({"floor": {"height": 0.01, "colliding": 10}, "colliding_points": 30})");
  check_json(json_of(require_success(garden.run("info b.h5 --json"))),
             R"({"floor": {"height": 0.01, "colliding": 10}})");
  require_success(garden.search("--floor 1cm --first-pose -o c.h5"));
  const Outcome listed = garden.run("conflicts c.h5 --trajectory path.txt --json");
  check_json(json_of(listed), R"({"floor": {"height": 0.01, "colliding": 10}})");
  check_says(garden.search("--floor 0.01 -o e.h5").out, verdict);
  check_says(garden.search("--floor -50 -o f.h5").out,
             "conflict, with no point within the radius below -50 m of the vehicle: 40 points");
  CHECK(json_of(garden.search("--json -o d.h5"))["floor"].is_null());
}

TEST_CASE("verdict, conflicts and all outputs say what the colliding points are classified as") {
  const Garden garden;
  const std::string words = "40 of 40 points are classified as low vegetation (3)";
  const Outcome searched = garden.search("--first-pose --clearance 0.2 --profile 2 -o a.h5");
  check_says(searched.out, "conflict: 40 points are closer than 0.1 m to the model on its way; " +
                               words + "; first at pose");
  check_says(searched.out, "of low vegetation (3)");
  const std::string path = " --trajectory path.txt ";
  const std::string table = require_success(garden.run("conflicts a.h5" + path)).out;
  check_says(table, "10 m of path; " + words);
  check_says(table, "classified");
  const Outcome files = garden.run("conflicts a.h5" + path +
                                   "-o a.csv -o a.json -o a.geojson -o a.gpkg -o a.bcf --json");
  check_json(json_of(require_success(files)), R"({"classes": {"3": 40}})");
  check_says(garden.bytes("a.csv"), "main_class,main_class_points");
  check_json(json::parse(garden.bytes("a.json")),
             R"({"conflicts": {"0": {"main_class": 3, "main_class_points": 40}}})");
  check_says(garden.bytes("a.geojson"), "\"main_class\"");
  check_says(garden.bytes("a.gpkg"), "main_class_points");
  require_success(garden.run("report a.h5 --env site.h5 --model car.xyz" + path + "-o a.html"));
  check_says(garden.bytes("a.html"), "\"classified\":\"" + words);
  require_success(garden.run("export a.h5 -o p.csv"));
  check_says(garden.bytes("p.csv"), "source,x,y,z,first_pose,class\n");
  require_success(garden.run("export a.h5 -o p.las"));
  require_success(garden.run("convert p.las -o p.h5"));
  check_says(garden.run("info p.h5").out, "3 (low vegetation): 40 points");
  require_success(garden.run("export a.h5 --what profile -o profile.csv"));
  check_says(garden.bytes("profile.csv"), "source,x,y,z,class\n");
  check_json(json_of(garden.search("--json --profile 2 -o b.h5")),
             R"({"classes": {"3": 40}, "least_profile": {"class": 3}})");
  check_outcome(garden.run("verify a.h5"), 0);
}

TEST_CASE("a verdict says nothing of classes that say nothing, and of none") {
  Garden garden;
  for (std::uint8_t& value : garden.las.bytes_of_class) value = value == 3 ? 1 : 6;
  garden.put("all.las", garden.las.build());
  require_success(garden.run("convert all.las -o plain.h5"));
  const auto is_silent = [](const Outcome& outcome) {
    return require_success(outcome).out.find("classified") == std::string::npos;
  };
  CHECK(is_silent(garden.search("--first-pose -o a.h5", "plain.h5")));
  CHECK(is_silent(garden.run("conflicts a.h5 --trajectory path.txt")));
  CHECK(is_silent(
      garden.run("run --env wall.h5 --model car.xyz --trajectory path.txt --radius 1.05 -o b.h5")));
}

TEST_CASE("a verdict names up to three classes, and says how many points have others") {
  Garden garden;
  std::uint32_t i = 0;
  for (std::uint8_t& value : garden.las.bytes_of_class) {
    if (value != 3) continue;
    value = i < 20 ? 18 : i < 30 ? 1 : i < 35 ? 24 : i < 38 ? 7 : i < 39 ? 2 : 5;
    ++i;
  }
  garden.put("all.las", garden.las.build());
  require_success(garden.run("convert all.las -o mixed.h5"));
  check_says(
      garden.search("-o a.h5", "mixed.h5").out,
      "20 of 40 points are classified as high noise (18), 5 as class 24, 3 as low noise (7), "
      "2 as others");
}

TEST_CASE("a verdict says what was ignored") {
  const Garden garden;
  check_says(garden.search("-o a.h5").out, "conflict: 40 points are closer");
  check_says(garden.search(kPlant + "-o b.h5").out,
             "clear with warnings, with 40 points ignored (class 3), 40 of which would collide: no "
             "other point "
             "is closer");
  check_says(garden.search(kPlantBox + "-o c.h5").out,
             "clear with warnings, with 40 points ignored (1 box), 40 of which would collide: no "
             "other point is closer");
  const Outcome both =
      garden.search("--ignore-class=2,6-7 --ignore-box=-1,0,-1,1,2,1 -o d.h5 --json");
  const json report = json_of(both);
  check_json(report, R"({
    "verdict": "conflict", "ignored": {"points": 2000, "colliding": 0,
    "boxes": {"0": {"points": 201}}}})");
  CHECK(report["ignored"]["classes"][1] == json{{"class", 6}, {"points", 2000}});
  CHECK(report["ignored"]["looked_at"].get<std::uint64_t>() <= 2000);
  check_says(report["warnings"].dump(), "absent-class");
  const json info = json_of(garden.run("info d.h5 --json"));
  check_json(info, R"({"ignored": {"points": 2000, "colliding": 0}, "version": 6})");
  check_says(garden.run("info site.h5").out, "6 (building): 2,000 points");
  check_outcome(garden.run("verify d.h5"), 0);
}

TEST_CASE("every engine gives the same bytes, whatever the order of what is ignored") {
  const Garden garden;
  require_success(garden.search("--ignore-class 6,1 --ignore-box 7.02,0,-1,8,1,1 -o a.h5"));
  for (const std::string engine : {"sweep", "grid", "kdtree"}) {
    require_success(
        garden.search("--ignore-box 7.02,0,-1,8,1,1 --ignore-class 1 --ignore-class 6 "
                      "--force -o b.h5 --engine " +
                      engine));
    check_same(garden.bytes("a.h5"), garden.bytes("b.h5"));
  }
}

TEST_CASE("what cannot be ignored is refused") {
  const Garden garden;
  const auto refusal = [&](const std::string& options, const std::string& store = "site.h5") {
    const Outcome outcome = garden.search(options + " -o a.h5", store);
    check_outcome(outcome, 2);
    return outcome.err;
  };
  check_says(refusal("--ignore-class ground"), "'ground': expected numbers of classes");
  check_says(refusal("--ignore-class 256"), "from 0 to 255");
  check_says(refusal("--ignore-class 7-3"), "'7-3'");
  check_says(refusal("--ignore-class 2,,7"), "'': expected");
  check_says(refusal("--ignore-box 1,2,3"), "expected six numbers");
  check_says(refusal("--ignore-box 1,2,3,4,x,6"), "'x' is no number");
  check_says(refusal("--ignore-box 1,2,3,4,nan,6"), "'nan' is no number");
  check_says(refusal("--ignore-box 5,2,3,4,5,6"), "the wrong way round");
  check_says(refusal("--ignore-class 3", "wall.h5"), "wall.h5 ... have no classes");
}

TEST_CASE("what leaves nothing out, and what leaves all out, is warned of") {
  const Garden garden;
  check_says(garden.search("--ignore-class 9 -o a.h5").err,
             "no point has class 9 ... has classes 3, 6");
  check_says(garden.search("--ignore-box 90,0,0,99,1,1 -o b.h5").err,
             "no point is in the ignored box 90 0 0 to 99 1 1");
  const Outcome all = garden.search("--ignore-class 3,6 -o c.h5 --fail-on-collision --json");
  check_says(all.err, "all points");
  check_outcome(all, 6);
  check_json(json_of(all), R"({"verdict": "undecided", "ignored": {"colliding": 40}})");
}

TEST_CASE("what ignoring points hides is warned of, and what is sound is not") {
  Garden garden;
  const auto warned = [&](const std::string& arguments, const std::string& store = "site.h5") {
    return garden.search(arguments + "-o out.h5 --force", store);
  };
  const Outcome plant = warned(kPlant);
  check_says(plant.err,
             "40 of the 40 points ignored (class 3) would collide, and no searched point does");
  check_says(plant.out, "; see the");
  check_says(warned(kPlantBox).err, "40 of the 40 points ignored (1 box)");
  check_lacks(warned("--ignore-class 6 ").err, "would collide");
  check_says(warned("--ignore-class 6 ").out,
             "2,000 points ignored (class 6), none of which would collide");
  check_outcome(garden.search(kPlant + "-o out.h5 --resume --json"),
                2);  // it is the result of another question
  require_success(warned(kPlant));
  const json again = json_of(garden.search(kPlant + "-o out.h5 --resume --json"));
  check_json(again, R"({"was_finished": true, "ignored": {"colliding": 40}})");
  check_says(again["warnings"].dump(), "ignored-collide");

  // A lamp hangs above the path, and the model is a metre high.
  garden.put("car.xyz", "0 0 0\n0 0 1\n");
  for (std::int32_t i = 0; i < 5; ++i) garden.add({3000 + i, 0, 1000}, 14);
  garden.put("all.las", garden.las.build());
  garden.succeed("convert all.las -o lamp.h5");
  const Outcome lamp = warned("--ignore-class 14 --floor -1 ", "lamp.h5");
  check_says(lamp.err,
             "5 of the 5 points ignored (class 14) would collide more than 0.5 m above the model's "
             "lowest point");
  check_lacks(lamp.err, "but only");

  // Ignoring a class that nearly all points have leaves a few.
  check_says(garden.search("--ignore-class 3,6 -o few.h5", "lamp.h5").err,
             "2,040 of 2,045 points of the environment are ignored, so that only 5 are searched");
}

TEST_CASE("parts and journals are of what was ignored") {
  const Garden garden;
  require_success(garden.search(kPlant + "--shard 1/2 -o p1.h5"));
  require_success(garden.search(kPlant + "--shard 2/2 -o p2.h5"));
  require_success(garden.search(kPlantBox + "--shard 2/2 -o q2.h5"));
  require_success(garden.search(kPlant + "-o whole.h5"));
  const Outcome merged = garden.run("merge p1.h5 p2.h5 -o m.h5");
  check_says(merged.out,
             "clear with warnings, with 40 points ignored (class 3), 40 of which would");
  check_says(merged.err, "would collide, and no searched point does");
  check_same(garden.bytes("m.h5"), garden.bytes("whole.h5"));
  check_outcome(garden.run("merge p1.h5 q2.h5 -o n.h5"), 3,
                "answers another question ... ignored points");
  check_outcome(garden.search(kPlantBox + "--resume -o whole.h5"), 2);
  check_outcome(garden.search(kPlant + "--resume -o whole.h5"), 0);
}
