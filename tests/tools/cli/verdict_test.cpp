#include <nlohmann/json.hpp>
#include <set>

#include "support/catch.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;

namespace {

/// A wall beside a path along x, one point of which is at y = 0.25; the model is a small cross.
struct Street : Workplace {
  Street() {
    std::string wall;
    for (int i = 0; i < 200; ++i) wall += std::to_string(i * 0.05) + " 1 0\n";
    put("wall.xyz", wall + "7 0.25 0\n");
    put("car.xyz", "0 0 0\n0.01 0 0\n-0.01 0 0\n0 0.01 0\n0 -0.01 0\n");
    std::string path = "name,time,x,y,z,qx,qy,qz,qw\n";
    for (int i = 0; i <= 100; ++i) {
      path += "P" + std::to_string(i) + "," + std::to_string(50 + i) + "," +
              std::to_string(i * 0.1) + ",0,0,0,0,0,1\n";
    }
    put("path.csv", path);
    require_success(run("convert wall.xyz -o site.h5"));
  }

  Outcome search(const std::string& arguments) const {
    return run("run --env site.h5 --model car.xyz --trajectory path.csv -o out.h5 --threads 2 " +
               arguments);
  }
};

std::vector<std::string> keys_of(const json& object) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.push_back(key);
  return keys;
}

}  // namespace

TEST_CASE("a run ends with one sentence: clear, and the least distance with its place") {
  const Street street;
  const Outcome bare = street.search("--radius 0.1");
  check_outcome(bare, 0, kAnything,
                "clear with warnings: no environment point is closer than 0.1 m to the model");
  CHECK(std::count(bare.out.begin(), bare.out.end(), '\n') == 1);
  check_outcome(street.search("--radius 0.1 --profile 0.5 --force --fail-on-collision"), 0,
                kAnything,
                "; the least distance is 0.24 m at pose 70 (P70, time 120, 7.00 m along the path), "
                "point 7.000 0.250 0.000");
  check_says(street.search("--radius 0.1 --clearance 0.2 --force").out, "; none is within 0.2 m");
}

TEST_CASE("a run ends with one sentence: conflict, its first and its worst place") {
  const Street street;
  const Outcome outcome = street.search("--radius 0.3 --first-pose --clearance 0.5");
  check_outcome(outcome, 0, kAnything,
                "conflict: 1 point is closer than 0.3 m to the model on its way; first at pose 69 "
                "(P69, time 119, 6.90 m along the path)");
  check_says(outcome.out, "the least distance is 0.24 m at pose 70 (P70");
  check_outcome(street.search("--radius 0.3 --resume --fail-on-collision"), 2);  // another query
  check_outcome(street.search("--radius 0.3 --force --fail-on-collision"), 1);
}

TEST_CASE("a run's JSON is complete, and has the same keys for a finished result") {
  const Street street;
  const std::string query = "--radius 0.3 --first-pose --clearance 0.5 --profile 0.4 --json ";
  const Outcome outcome = street.search(query + "--fail-on-collision");
  check_outcome(outcome, 1);
  const json report = json_of(outcome);
  CHECK(report["version"].is_string());
  CHECK(keys_of(report["files"]) ==
        std::vector<std::string>{"env", "model", "output", "trajectory"});
  check_json(report, R"({
    "files": {"env": "site.h5"}, "radius": 0.3, "verdict": "conflict", "colliding_points": 1,
    "first_place": {"pose": 69, "name": "P69"}, "least_clearance": {"source": 200},
    "least_profile": {"pose": 70, "time": 120}})");
  check_near(report, "/first_place/chainage", 6.9);
  check_near(report, "/least_clearance/distance", 0.24);
  check_near(report, "/least_clearance/y", 0.25);
  check_says(outcome.err, "conflict: 1 point");

  const json finished = json_of(check_outcome(street.search(query + "--resume"), 0));
  CHECK(keys_of(finished) == keys_of(report));
  check_json(finished, R"({"was_finished": true, "engine": null})");
  for (const char* key : {"files", "verdict", "least_clearance", "least_profile", "first_place",
                          "profile_poses", "clearance_points"}) {
    CAPTURE(key);
    CHECK(finished[key] == report[key]);
  }
}

TEST_CASE("what was not asked for is null in a run's JSON") {
  const Street street;
  const json report = json_of(street.search("--radius 0.1 --json"));
  check_json(report, R"({"verdict": "clear"})");
  for (const char* key : {"least_clearance", "least_profile", "first_place"}) {
    CHECK(report[key].is_null());
  }
}

TEST_CASE("a profile is exported with the trajectory's times and names") {
  const Street street;
  require_success(street.search("--radius 0.1 --profile 0.5"));
  check_json(json_of(require_success(
                 street.run("export out.h5 --what profile --trajectory path.csv -o p.csv --json"))),
             R"({"rows": 101})");
  const std::string text = street.bytes("p.csv");
  check_says(text, "pose,time,name,chainage,distance,source,x,y,z\n0,50,P0,0,,,,,\n");
  check_says(text, "\n70,120,P70, ... ,200,7,0.25,0\n");

  std::string other = street.bytes("path.csv");
  other.replace(other.find("0.100000"), 8, "0.200000");
  street.put("path.csv", other);
  check_outcome(street.run("export out.h5 --what profile --trajectory path.csv -o p.csv --force"),
                3, "path.csv ... other poses");
}

TEST_CASE("stations of the trajectory stand beside the chainage") {
  const Street street;
  std::string path = "station [m],x,y,z,qx,qy,qz,qw\n";
  for (int i = 0; i <= 100; ++i) {
    path += std::to_string(2000 - 2 * i) + "," + std::to_string(i * 0.1) + ",0,0,0,0,0,1\n";
  }
  street.put("path.csv", path);
  const Outcome outcome = require_success(
      street.search("--radius 0.3 --profile 0.5 --clearance 0.5 --first-pose --json"));
  check_says(outcome.err, "(station 18 ...  m along the path)");
  const json report = json_of(outcome);
  for (const char* place : {"first_place", "least_clearance", "least_profile"}) {
    CAPTURE(place);
    CHECK(report[place]["station"] == 2000 - 2 * report[place]["pose"].get<int>());
    CHECK_FALSE(report[place].contains("name"));
  }
  const std::string trajectory = " --trajectory path.csv ";
  street.succeed("export out.h5 --what profile" + trajectory + "-o p.csv");
  check_says(street.bytes("p.csv"),
             "pose,station,chainage,distance,source,x,y,z\n0,2000,0,,,,,\n1,1998,0.1,");
  const Outcome conflicts = street.run("conflicts out.h5" + trajectory + "--min-points 1");
  INFO(conflicts.err);
  check_says(conflicts.out, "station (m) ... 18");
  check_says(street.run("conflicts out.h5" + trajectory + "--min-points 1000").out, "(station 18");
  check_says(street.succeed("stations out.h5" + trajectory + "--every 5 -o p.csv --force").out,
             "2 stretches of 5 m along 10 m of path ... 2000.00 - 1900.00 ... conflict");
  check_says(street.bytes("p.csv"), "\n5,10,1900,1800,");
  street.check({
      {"stations out.h5" + trajectory + "-o p.txt", 2},
      {"stations out.h5" + trajectory + "--every 0", 2},
      {"stations out.h5" + trajectory + "--every 1e-6", 2},
  });
  check_json(json_of(street.run("stations out.h5" + trajectory + "--json")),
             R"({"station_count": 2})");
  require_success(street.search("--radius 0.3 --force"));
  check_outcome(street.run("stations out.h5" + trajectory), 2,
                "has no first poses ... --first-pose");
}

TEST_CASE("combinations of export that make no sense are refused") {
  const Street street;
  require_success(street.search("--radius 0.1"));
  street.check({
      {"export out.h5 --what profile --trajectory path.csv --force -o path.csv", 2,
       "path.csv: is an input too"},
      {"export out.h5 --what profile -o p.csv", 2, "makes a result with a profile"},
      {"export out.h5 --trajectory path.csv -o p.csv", 2},
      {"export out.h5 --what clearance --scans wall.xyz -o p.csv", 2},
  });
}

TEST_CASE("info says which source indices come from which file") {
  const Street street;
  std::filesystem::create_directory(street.folder / "scans");
  street.put("scans/a.xyz", "0 0 0\n1 1 1\n2 2 2\n");
  street.put("scans/b.xyz", "5 5 5\n6 6 6\n");
  const std::string scans = "scans";
  const json made = json_of(street.run("convert " + scans + " -o site.h5 --force --json"));
  check_json(made, R"({"sources": {"1": {"first_source": 3}}})");
  CHECK(made["files"]["inputs"].size() == 1);
  const json again = json_of(street.run("convert " + scans + " -o site.h5 --resume --json"));
  CHECK(keys_of(again) == keys_of(made));
  CHECK(again["sources"] == made["sources"]);
  check_says(street.run("info site.h5").out, "source indices 0 to 2\n ... source indices 3 to 4\n");
}

TEST_CASE("verify's JSON says whether a file is sound, and what is wrong") {
  const Street street;
  const json sound = json_of(street.run("verify site.h5 --json"));
  check_json(sound, R"({"sound": true})");
  CHECK((sound["faults"].empty() && sound["remark"].is_null()));
  const json damaged = json_of(check_outcome(street.run("verify wall.xyz --json"), 1));
  check_json(damaged, R"({"sound": false})");
  CHECK(damaged["faults"].size() == 1);
}

TEST_CASE("a question in doubt is undecided, and stays so for whoever reads the result later") {
  const Street street;
  street.put("far.txt", path_along_x(101, 0.1, 5000));
  const std::string run_text =
      "run --env site.h5 --model car.xyz --trajectory far.txt --radius 0.1 --threads 2 ";
  const std::string judged = run_text + "--fail-on-collision ";
  const Outcome first = street.run(judged + "-o far.h5");
  check_outcome(first, 6, kAnything,
                "undecided, because the question is in doubt (out-of-reach), so what stands in the "
                "way may not have been found: no environment point is closer than 0.1 m ... ; see "
                "the");
  check_lacks(first.out, "clear");
  check_outcome(street.run(run_text + "--force -o far.h5"), 0);

  check_json(json_of(check_outcome(street.run(judged + "--resume --json -o far.h5"), 6)), R"({
    "was_finished": true, "verdict": "undecided", "reasons": ["question-in-doubt"],
    "margins": null, "seen": null})");

  check_json(json_of(street.run("info --json far.h5")),
             R"({"verdict": "undecided", "doubts": ["out-of-reach"]})");

  const Outcome report = street.run(
      "report far.h5 --env site.h5 --model car.xyz --trajectory far.txt --json -o far.html");
  INFO(report.err);
  check_json(json_of(report), R"({"verdict": "undecided", "reasons": ["question-in-doubt"]})");
  check_says(report.err, "undecided, 0 colliding points");

  check_says(street.run("compare far.h5 far.h5").err,
             "its verdict is undecided, because the question is in doubt (out-of-reach)");
  street.succeed(run_text + "--first-pose --force -o first.h5");
  const Outcome listed = street.run("conflicts first.h5 --trajectory far.txt");
  INFO(listed.err);
  const std::string undecided =
      "the verdict of this result is undecided, because the question is in doubt (out-of-reach)";
  check_says(listed.out, "no conflicts, because no point collides\n" + undecided);
  check_says(listed.err, "its verdict is undecided");
  check_json(json_of(street.run("conflicts --json first.h5 --trajectory far.txt")),
             R"({"verdict": "undecided", "doubts": ["out-of-reach"]})");
  const Outcome exported = street.run("export --json far.h5 -o far.csv");
  check_says(exported.err, "warning:  ... " + undecided);
  check_json(json_of(exported), R"({"verdict": "undecided"})");

  for (const std::string part : {"1", "2"}) {
    check_json(json_of(street.run(run_text + "--shard " + part + "/2 --json -o " +
                                  std::string("part") + part + ".h5")),
               R"({"verdict": "unknown", "reasons": []})");
  }
  const std::string merge = "merge part1.h5 part2.h5 -o m.h5";
  check_json(json_of(check_outcome(street.run(merge + " --fail-on-collision --json"), 6)),
             R"({"verdict": "undecided"})");
  check_same(street.bytes("m.h5"), street.bytes("far.h5"));
  check_outcome(street.run(merge + " --fail-on-collision --resume"), 6);
}

TEST_CASE("an all-clear that was warned of is never repeated without the warnings") {
  const Street street;
  const json report = json_of(street.search("--radius 0.1 --first-pose --json"));
  check_json(report, R"({"verdict": "clear"})");
  std::set<std::string> codes;
  for (const json& warning : report["warnings"]) codes.insert(warning["code"]);
  REQUIRE(!codes.empty());
  CHECK(json_of(street.run("info --json out.h5"))["warned_of"] == json(codes));
  const std::string clause = "; its run warned of " + *codes.begin();
  check_says(street.run("conflicts out.h5 --trajectory path.csv").out,
             "is clear with warnings:  ... " + clause);
  check_says(street.run("export out.h5 -o p.csv").err, clause);
  // A result that collides keeps them too.
  const json colliding = json_of(street.search("--radius 0.3 --force --json"));
  check_json(colliding, R"({"verdict": "conflict"})");
  CHECK(!colliding["warnings"].empty());
  CHECK(json_of(street.run("info --json out.h5"))["warnings"] == colliding["warnings"]);
}

TEST_CASE("a least distance is told without the rounding of its coordinates") {
  const Street street;
  street.put("car.xyz", "0 0.25000008507 0\n");
  check_says(street.search("--radius 0.1 --clearance 0.2").out, "the least distance is 0 m at");
}

TEST_CASE("one colliding point is a conflict, however doubtful the question is") {
  const Street street;
  check_json(json_of(check_outcome(street.search("--radius 0.3 --json --fail-on-collision"), 1)),
             R"({"verdict": "conflict", "reasons": []})");
}

TEST_CASE("the hash of a result is that of its question, inputs and answer") {
  const Street street;
  const auto hash = [&](const std::string& arguments) {
    const Outcome found = require_success(street.search("--force --json " + arguments));
    CHECK(json_of(found)["verdict"] == "clear");
    const Outcome page = require_success(
        street.run("report out.h5 --env site.h5 --model car.xyz --trajectory path.csv -o page.html "
                   "--force --json"));
    return json_of(page)["inputs"]["result"]["hash"].get<std::string>();
  };
  const std::string first = hash("--radius 0.1");
  CHECK(hash("--radius 0.1 --engine sweep") == first);
  CHECK(hash("--radius 0.12") != first);
  CHECK(hash("--radius 0.1 --profile 0.5") != first);
  CHECK(hash("--radius 0.1 --floor -1") != first);
  street.put("wall.xyz", street.bytes("wall.xyz") + "3 2 0\n");
  require_success(street.run("convert wall.xyz -o site.h5 --force"));
  CHECK(hash("--radius 0.1") != first);
}
