// Ignored classes and boxes as a user sees them.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "support/bytes/las_bytes.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;
using nlohmann::json;

namespace {

/// A wall of class 6 beside a path along x, and a plant of class 3 in the way.
struct Garden {
  Garden() {
    for (std::int32_t i = 0; i < 2000; ++i) add({i * 5, 1000, 0}, 6);
    for (std::int32_t i = 0; i < 40; ++i) add({7000 + i, 50, i}, 3);
    put_bytes(folder / "all.las", las.build());
    put_bytes(folder / "wall.xyz", "0 1 0\n1 1 0\n");
    put_bytes(folder / "car.xyz", "0 0 0\n0.01 0 0\n-0.01 0 0\n0 0.01 0\n0 -0.01 0\n");
    std::string path;
    for (int i = 0; i <= 100; ++i) {
      path += "1 0 0 " + std::to_string(i * 0.1) + " 0 1 0 0 0 0 1 0\n";
    }
    put_bytes(folder / "path.txt", path);
    REQUIRE(program("convert all.las -o site.h5 --cell-points 64").exit_code == 0);
    REQUIRE(program("convert wall.xyz -o wall.h5").exit_code == 0);
  }

  void add(const std::array<std::int32_t, 3>& point, std::uint8_t point_class) {
    las.scale = {0.001, 0.001, 0.001};
    las.offset = {0, 0, 0};
    if (las.bytes_of_class.empty()) las.points.clear();
    las.points.push_back(point);
    las.bytes_of_class.push_back(point_class);
  }
  Outcome program(const std::string& arguments) const {
    return run_program_at("env", folder,
                          "-C " + quoted(folder / "") + " '" CLEARWAY_PROGRAM "' " + arguments);
  }
  Outcome run(const std::string& arguments, const std::string& store = "site.h5") const {
    return program("run --env " + store +
                   " --model car.xyz --trajectory path.txt --threads 2 --radius 0.1 " + arguments);
  }
  std::string bytes(const std::string& name) const { return bytes_of(folder / name); }

  ScratchFolder folder;
  LasBytes las;
};

const std::string kPlant = "--ignore-class 3 ";
const std::string kPlantBox = "--ignore-box 6.9,0,-1,7.1,0.5,1 ";

}  // namespace

TEST_CASE("conflicts and export of a result repeat how many ignored points would collide") {
  const Garden garden;
  REQUIRE(garden.run(kPlant + "--first-pose -o b.h5").exit_code == 0);
  const std::string verdict =
      "the verdict of this result is clear, with 40 points ignored (class 3), 40 of which would "
      "collide: no other point is closer";
  CHECK_THAT(garden.program("conflicts b.h5 --trajectory path.txt").out, Contains(verdict));
  const Outcome listed = garden.program("conflicts b.h5 --trajectory path.txt --json");
  CHECK(json::parse(listed.out)["ignored_colliding"] == 40);
  CHECK_THAT(listed.err, Contains(verdict));
  const Outcome exported = garden.program("export b.h5 -o b.csv --json");
  CHECK_THAT(exported.err, Contains(verdict));
  CHECK(json::parse(exported.out)["ignored"]["colliding"] == 40);
}

TEST_CASE("a verdict says what was ignored") {
  const Garden garden;
  CHECK_THAT(garden.run("-o a.h5").out, Contains("conflict: 40 points are closer"));
  CHECK_THAT(
      garden.run(kPlant + "-o b.h5").out,
      Contains("clear, with 40 points ignored (class 3), 40 of which would collide: no other "
               "point is closer"));
  CHECK_THAT(garden.run(kPlantBox + "-o c.h5").out,
             Contains("clear, with 40 points ignored (1 box), 40 of which would collide: no other "
                      "point is closer"));
  const Outcome both = garden.run("--ignore-class=2,6-7 --ignore-box=-1,0,-1,1,2,1 -o d.h5 --json");
  const json report = json::parse(both.out);
  CHECK(report["verdict"] == "conflict");
  CHECK(report["ignored"]["points"] == 2000);
  CHECK(report["ignored"]["colliding"] == 0);
  CHECK(report["ignored"]["classes"][1] == json{{"class", 6}, {"points", 2000}});
  CHECK(report["ignored"]["boxes"][0]["points"] == 201);
  CHECK(report["ignored"]["looked_at"].get<std::uint64_t>() <= 2000);
  CHECK_THAT(report["warnings"].dump(), Contains("absent-class"));
  const json info = json::parse(garden.program("info d.h5 --json").out);
  CHECK(info["ignored"]["points"] == 2000);
  CHECK(info["ignored"]["colliding"] == 0);
  CHECK(info["version"] == 6);
  CHECK_THAT(garden.program("info site.h5").out, Contains("6 (building): 2,000 points"));
  CHECK(garden.program("verify d.h5").exit_code == 0);
}

TEST_CASE("every engine gives the same bytes, whatever the order of what is ignored") {
  const Garden garden;
  REQUIRE(garden.run("--ignore-class 6,1 --ignore-box 7.02,0,-1,8,1,1 --first-pose -o a.h5")
              .exit_code == 0);
  for (const std::string engine : {"sweep", "grid", "kdtree"}) {
    REQUIRE(garden
                .run("--ignore-box 7.02,0,-1,8,1,1 --ignore-class 1 --ignore-class 6 --first-pose "
                     "--force -o b.h5 --engine " +
                     engine)
                .exit_code == 0);
    CHECK(garden.bytes("a.h5") == garden.bytes("b.h5"));
  }
}

TEST_CASE("what cannot be ignored is refused") {
  const Garden garden;
  const auto refusal = [&](const std::string& options, const std::string& store = "site.h5") {
    const Outcome outcome = garden.run(options + " -o a.h5", store);
    CHECK(outcome.exit_code == 2);
    return outcome.err;
  };
  CHECK_THAT(refusal("--ignore-class ground"), Contains("'ground': expected numbers of classes"));
  CHECK_THAT(refusal("--ignore-class 256"), Contains("from 0 to 255"));
  CHECK_THAT(refusal("--ignore-class 7-3"), Contains("'7-3'"));
  CHECK_THAT(refusal("--ignore-class 2,,7"), Contains("'': expected"));
  CHECK_THAT(refusal("--ignore-box 1,2,3"), Contains("expected six numbers"));
  CHECK_THAT(refusal("--ignore-box 1,2,3,4,x,6"), Contains("'x' is no number"));
  CHECK_THAT(refusal("--ignore-box 1,2,3,4,nan,6"), Contains("'nan' is no number"));
  CHECK_THAT(refusal("--ignore-box 5,2,3,4,5,6"), Contains("the wrong way round"));
  CHECK_THAT(refusal("--ignore-class 3", "wall.h5"),
             Contains("wall.h5") && Contains("have no classes"));
}

TEST_CASE("what leaves nothing out, and what leaves all out, is warned of") {
  const Garden garden;
  CHECK_THAT(garden.run("--ignore-class 9 -o a.h5").err,
             Contains("no point has class 9") && Contains("has classes 3, 6"));
  CHECK_THAT(garden.run("--ignore-box 90,0,0,99,1,1 -o b.h5").err,
             Contains("no point is in the ignored box 90 0 0 to 99 1 1"));
  const Outcome all = garden.run("--ignore-class 3,6 -o c.h5 --fail-on-collision --json");
  CHECK_THAT(all.err, Contains("all points"));
  CHECK(all.exit_code == 6);
  CHECK(json::parse(all.out)["verdict"] == "undecided");
  CHECK(json::parse(all.out)["ignored"]["colliding"] == 40);
}

TEST_CASE("what ignoring points hides is warned of, and what is sound is not") {
  Garden garden;
  const auto warned = [&](const std::string& arguments, const std::string& store = "site.h5") {
    return garden.run(arguments + "-o out.h5 --force", store);
  };
  const Outcome plant = warned(kPlant);
  CHECK_THAT(plant.err, Contains("40 of the 40 points ignored (class 3) would collide, and no "
                                 "searched point does"));
  CHECK_THAT(plant.out, Contains("but see the"));
  CHECK_THAT(warned(kPlantBox).err, Contains("40 of the 40 points ignored (1 box)"));
  CHECK_THAT(warned("--ignore-class 6 ").err, !Contains("would collide"));
  CHECK_THAT(warned("--ignore-class 6 ").out,
             Contains("2,000 points ignored (class 6), none of which would collide"));
  const Outcome finished = garden.run(kPlant + "-o out.h5 --resume --json");
  CHECK(finished.exit_code == 2);  // it is the result of another question
  REQUIRE(warned(kPlant).exit_code == 0);
  const json again = json::parse(garden.run(kPlant + "-o out.h5 --resume --json").out);
  CHECK(again["was_finished"] == true);
  CHECK(again["ignored"]["colliding"] == 40);
  CHECK_THAT(again["warnings"].dump(), Contains("ignored-collide"));

  // A lamp hangs above the path, and the model is a metre high.
  put_bytes(garden.folder / "car.xyz", "0 0 0\n0 0 1\n");
  for (std::int32_t i = 0; i < 5; ++i) garden.add({3000 + i, 0, 1000}, 14);
  put_bytes(garden.folder / "all.las", garden.las.build());
  REQUIRE(garden.program("convert all.las -o lamp.h5").exit_code == 0);
  const Outcome lamp = warned("--ignore-class 14 --model-above -1 ", "lamp.h5");
  CHECK_THAT(lamp.err, Contains("5 of the 5 points ignored (class 14) would collide more than 0.5 "
                                "m above the model's lowest point"));
  CHECK_THAT(lamp.err, !Contains("but only"));

  // Ignoring a class that nearly all points have leaves a few.
  CHECK_THAT(garden.run("--ignore-class 3,6 -o few.h5", "lamp.h5").err,
             Contains("2,040 of 2,045 points of the environment are ignored, so that only 5 are "
                      "searched"));
}

TEST_CASE("parts and journals are of what was ignored") {
  const Garden garden;
  REQUIRE(garden.run(kPlant + "--shard 1/2 -o p1.h5").exit_code == 0);
  REQUIRE(garden.run(kPlant + "--shard 2/2 -o p2.h5").exit_code == 0);
  REQUIRE(garden.run(kPlantBox + "--shard 2/2 -o q2.h5").exit_code == 0);
  REQUIRE(garden.run(kPlant + "-o whole.h5").exit_code == 0);
  const Outcome merged = garden.program("merge p1.h5 p2.h5 -o m.h5");
  CHECK_THAT(merged.out, Contains("clear, with 40 points ignored (class 3), 40 of which would"));
  CHECK_THAT(merged.err, Contains("would collide, and no searched point does"));
  CHECK(garden.bytes("m.h5") == garden.bytes("whole.h5"));
  const Outcome other = garden.program("merge p1.h5 q2.h5 -o n.h5");
  CHECK(other.exit_code == 3);
  CHECK_THAT(other.err, Contains("answers another question") && Contains("ignored points"));
  const Outcome again = garden.run(kPlantBox + "--resume -o whole.h5");
  CHECK(again.exit_code == 2);
  CHECK(garden.run(kPlant + "--resume -o whole.h5").exit_code == 0);
}
