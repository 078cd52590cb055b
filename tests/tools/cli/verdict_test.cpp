#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <set>

#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;
using nlohmann::json;

namespace {

/// A wall beside a path along x, one point of which is at y = 0.25; the model is a small cross.
struct Street {
  Street() {
    std::string wall;
    for (int i = 0; i < 200; ++i) wall += std::to_string(i * 0.05) + " 1 0\n";
    put_bytes(folder / "wall.xyz", wall + "7 0.25 0\n");
    put_bytes(folder / "car.xyz", "0 0 0\n0.01 0 0\n-0.01 0 0\n0 0.01 0\n0 -0.01 0\n");
    std::string path = "name,time,x,y,z,qx,qy,qz,qw\n";
    for (int i = 0; i <= 100; ++i) {
      path += "P" + std::to_string(i) + "," + std::to_string(50 + i) + "," +
              std::to_string(i * 0.1) + ",0,0,0,0,0,1\n";
    }
    put_bytes(folder / "path.csv", path);
    REQUIRE(program("convert wall.xyz -o site.h5").exit_code == 0);
  }

  /// Runs the program. arguments: names of files are those in the folder.
  Outcome program(std::string arguments) const {
    for (const char* name : {"wall.xyz", "site.h5", "car.xyz", "path.csv", "out.h5", "p.csv"}) {
      const auto at = arguments.find(name);
      if (at == std::string::npos) continue;
      arguments.replace(at, std::string(name).size(), quoted(folder / name));
    }
    return run_program(folder, arguments);
  }

  Outcome run(const std::string& arguments) const {
    return program(
        "run --env site.h5 --model car.xyz --trajectory path.csv -o out.h5 --threads 2 " +
        arguments);
  }

  ScratchFolder folder;
};

std::vector<std::string> keys_of(const json& object) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.push_back(key);
  return keys;
}

}  // namespace

TEST_CASE("a run ends with one sentence: clear, and the least distance with its place") {
  const Street street;
  const Outcome bare = street.run("--radius 0.1");
  INFO(bare.err);
  CHECK(bare.exit_code == 0);
  CHECK_THAT(bare.out, Contains("clear: no environment point is closer than 0.1 m to the model"));
  CHECK(std::count(bare.out.begin(), bare.out.end(), '\n') == 1);
  const Outcome near = street.run("--radius 0.1 --profile 0.5 --force --fail-on-collision");
  CHECK(near.exit_code == 0);
  CHECK_THAT(near.out, Contains("; the least distance is 0.24 m at pose 70 (P70, time 120, "
                                "7.00 m along the path), point 7.000 0.250 0.000"));
  const Outcome far = street.run("--radius 0.1 --clearance 0.2 --force");
  CHECK_THAT(far.out, Contains("; none is within 0.2 m"));
}

TEST_CASE("a run ends with one sentence: conflict, its first and its worst place") {
  const Street street;
  const Outcome outcome = street.run("--radius 0.3 --first-pose --clearance 0.5");
  INFO(outcome.err);
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.out,
             Contains("conflict: 1 point is closer than 0.3 m to the model on its way; "
                      "first at pose 69 (P69, time 119, 6.90 m along the path)"));
  CHECK_THAT(outcome.out, Contains("the least distance is 0.24 m at pose 70 (P70"));
  CHECK(street.run("--radius 0.3 --resume --fail-on-collision").exit_code == 2);  // another query
  CHECK(street.run("--radius 0.3 --force --fail-on-collision").exit_code == 1);
}

TEST_CASE("a run's JSON is complete, and has the same keys for a finished result") {
  const Street street;
  const std::string query = "--radius 0.3 --first-pose --clearance 0.5 --profile 0.4 --json ";
  const Outcome outcome = street.run(query + "--fail-on-collision");
  INFO(outcome.err);
  CHECK(outcome.exit_code == 1);
  const json report = json::parse(outcome.out);
  CHECK(report["version"].is_string());
  CHECK(report["files"]["env"] == (street.folder / "site.h5").string());
  CHECK(keys_of(report["files"]) ==
        std::vector<std::string>{"env", "model", "output", "trajectory"});
  CHECK(report["radius"] == 0.3);
  CHECK(report["verdict"] == "conflict");
  CHECK(report["colliding_points"] == 1);
  CHECK(report["first_place"]["pose"] == 69);
  CHECK(report["first_place"]["name"] == "P69");
  CHECK(report["first_place"]["chainage"].get<double>() == Approx(6.9));
  CHECK(report["least_clearance"]["distance"].get<double>() == Approx(0.24));
  CHECK(report["least_clearance"]["source"] == 200);
  CHECK(report["least_clearance"]["y"].get<double>() == Approx(0.25));
  CHECK(report["least_profile"]["pose"] == 70);
  CHECK(report["least_profile"]["time"] == 120);
  CHECK_THAT(outcome.err, Contains("conflict: 1 point"));

  const Outcome again = street.run(query + "--resume");
  CHECK(again.exit_code == 0);
  const json finished = json::parse(again.out);
  CHECK(keys_of(finished) == keys_of(report));
  CHECK(finished["was_finished"] == true);
  CHECK(finished["engine"].is_null());
  for (const char* key : {"files", "verdict", "least_clearance", "least_profile", "first_place",
                          "profile_poses", "clearance_points"}) {
    CAPTURE(key);
    CHECK(finished[key] == report[key]);
  }
}

TEST_CASE("what was not asked for is null in a run's JSON") {
  const Street street;
  const json report = json::parse(street.run("--radius 0.1 --json").out);
  CHECK(report["verdict"] == "clear");
  for (const char* key : {"least_clearance", "least_profile", "first_place"}) {
    CHECK(report[key].is_null());
  }
}

TEST_CASE("a profile is exported with the trajectory's times and names") {
  const Street street;
  REQUIRE(street.run("--radius 0.1 --profile 0.5").exit_code == 0);
  const Outcome outcome =
      street.program("export out.h5 --what profile --trajectory path.csv -o p.csv --json");
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  CHECK(json::parse(outcome.out)["rows"] == 101);
  const std::string text = bytes_of(street.folder / "p.csv");
  CHECK_THAT(text, Contains("pose,time,name,chainage,distance,source,x,y,z\n0,50,P0,0,,,,,\n"));
  CHECK_THAT(text, Contains("\n70,120,P70,") && Contains(",200,7,0.25,0\n"));

  std::string other = bytes_of(street.folder / "path.csv");
  other.replace(other.find("0.100000"), 8, "0.200000");
  put_bytes(street.folder / "path.csv", other);
  const Outcome refused =
      street.program("export out.h5 --what profile --trajectory path.csv -o p.csv --force");
  CHECK(refused.exit_code == 3);
  CHECK_THAT(refused.err, Contains("path.csv") && Contains("other poses"));
}

TEST_CASE("stations of the trajectory stand beside the chainage") {
  const Street street;
  std::string path = "station [m],x,y,z,qx,qy,qz,qw\n";
  for (int i = 0; i <= 100; ++i) {
    path += std::to_string(2000 - 2 * i) + "," + std::to_string(i * 0.1) + ",0,0,0,0,0,1\n";
  }
  put_bytes(street.folder / "path.csv", path);
  const Outcome outcome =
      street.run("--radius 0.3 --profile 0.5 --clearance 0.5 --first-pose --json");
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  CHECK_THAT(outcome.err, Contains("(station 18") && Contains(" m along the path)"));
  const json report = json::parse(outcome.out);
  for (const char* place : {"first_place", "least_clearance", "least_profile"}) {
    CAPTURE(place);
    CHECK(report[place]["station"] == 2000 - 2 * report[place]["pose"].get<int>());
    CHECK_FALSE(report[place].contains("name"));
  }
  const std::string trajectory = " --trajectory path.csv ";
  REQUIRE(street.program("export out.h5 --what profile" + trajectory + "-o p.csv").exit_code == 0);
  CHECK_THAT(bytes_of(street.folder / "p.csv"),
             Contains("pose,station,chainage,distance,source,x,y,z\n0,2000,0,,,,,\n1,1998,0.1,"));
  const Outcome conflicts = street.program("conflicts out.h5" + trajectory + "--min-points 1");
  INFO(conflicts.err);
  CHECK_THAT(conflicts.out, Contains("station (m)") && Contains("18"));
  const Outcome small = street.program("conflicts out.h5" + trajectory + "--min-points 1000");
  CHECK_THAT(small.out, Contains("(station 18"));
  const Outcome table =
      street.program("stations out.h5" + trajectory + "--every 5 -o p.csv --force");
  INFO(table.err);
  REQUIRE(table.exit_code == 0);
  CHECK_THAT(table.out, Contains("2 stretches of 5 m along 10 m of path") &&
                            Contains("2000.00 - 1900.00") && Contains("conflict"));
  CHECK_THAT(bytes_of(street.folder / "p.csv"), Contains("\n5,10,1900,1800,"));
  CHECK(street.program("stations out.h5" + trajectory + "-o p.txt").exit_code == 2);
  CHECK(street.program("stations out.h5" + trajectory + "--every 0").exit_code == 2);
  CHECK(street.program("stations out.h5" + trajectory + "--every 1e-6").exit_code == 2);
  const Outcome summary = street.program("stations out.h5" + trajectory + "--json");
  CHECK(json::parse(summary.out)["station_count"] == 2);
  REQUIRE(street.run("--radius 0.3 --force").exit_code == 0);
  const Outcome lacking = street.program("stations out.h5" + trajectory);
  CHECK(lacking.exit_code == 2);
  CHECK_THAT(lacking.err, Contains("has no first poses") && Contains("--first-pose"));
}

TEST_CASE("combinations of export that make no sense are refused") {
  const Street street;
  REQUIRE(street.run("--radius 0.1").exit_code == 0);
  const Outcome own =
      street.program("export out.h5 --what profile --trajectory path.csv --force -o " +
                     quoted(street.folder / "path.csv"));
  CHECK(own.exit_code == 2);
  CHECK_THAT(own.err, Contains("path.csv: is an input too"));
  const Outcome none = street.program("export out.h5 --what profile -o p.csv");
  CHECK(none.exit_code == 2);
  CHECK_THAT(none.err, Contains("makes a result with a profile"));
  CHECK(street.program("export out.h5 --trajectory path.csv -o p.csv").exit_code == 2);
  CHECK(street.program("export out.h5 --what clearance --scans wall.xyz -o p.csv").exit_code == 2);
}

TEST_CASE("info says which source indices come from which file") {
  const Street street;
  std::filesystem::create_directory(street.folder / "scans");
  put_bytes(street.folder / "scans/a.xyz", "0 0 0\n1 1 1\n2 2 2\n");
  put_bytes(street.folder / "scans/b.xyz", "5 5 5\n6 6 6\n");
  const std::string scans = quoted(street.folder / "scans");
  const json made =
      json::parse(street.program("convert " + scans + " -o site.h5 --force --json").out);
  CHECK(made["sources"][1]["first_source"] == 3);
  CHECK(made["files"]["inputs"].size() == 1);
  const json again =
      json::parse(street.program("convert " + scans + " -o site.h5 --resume --json").out);
  CHECK(keys_of(again) == keys_of(made));
  CHECK(again["sources"] == made["sources"]);
  CHECK_THAT(street.program("info site.h5").out,
             Contains("source indices 0 to 2\n") && Contains("source indices 3 to 4\n"));
}

TEST_CASE("verify's JSON says whether a file is sound, and what is wrong") {
  const Street street;
  const json sound = json::parse(street.program("verify site.h5 --json").out);
  CHECK(sound["sound"] == true);
  CHECK((sound["faults"].empty() && sound["remark"].is_null()));
  const Outcome outcome = street.program("verify wall.xyz --json");
  CHECK(outcome.exit_code == 1);
  const json damaged = json::parse(outcome.out);
  CHECK(damaged["sound"] == false);
  CHECK(damaged["faults"].size() == 1);
}

TEST_CASE("a question in doubt is undecided, and stays so for whoever reads the result later") {
  const Street street;
  std::string path;
  for (int i = 0; i <= 100; ++i) {
    path += "1 0 0 " + std::to_string(5000 + i * 0.1) + " 0 1 0 0 0 0 1 0\n";
  }
  put_bytes(street.folder / "far.txt", path);
  const auto at = [&](const std::string& name) { return quoted(street.folder / name); };
  const auto run = [&](const std::string& arguments) {
    return run_program(street.folder, arguments);
  };
  const std::string run_text = "run --env " + at("site.h5") + " --model " + at("car.xyz") +
                               " --trajectory " + at("far.txt") + " --radius 0.1 --threads 2 ";
  const std::string judged = run_text + "--fail-on-collision ";
  const Outcome first = run(judged + "-o " + at("far.h5"));
  INFO(first.err);
  CHECK(first.exit_code == 6);
  CHECK_THAT(first.out, Contains("undecided, because the question is in doubt (out-of-reach): no "
                                 "environment point is closer than 0.1 m") &&
                            Contains("but see the"));
  CHECK_THAT(first.out, !Contains("clear"));
  CHECK(run(run_text + "--force -o " + at("far.h5")).exit_code == 0);

  const Outcome again = run(judged + "--resume --json -o " + at("far.h5"));
  CHECK(again.exit_code == 6);
  const json finished = json::parse(again.out);
  CHECK(finished["was_finished"] == true);
  CHECK(finished["verdict"] == "undecided");
  CHECK(finished["reasons"] == json{"question-in-doubt"});
  CHECK(finished["margins"].is_null());
  CHECK(finished["seen"].is_null());

  const json info = json::parse(run("info --json " + at("far.h5")).out);
  CHECK(info["verdict"] == "undecided");
  CHECK(info["doubts"] == json{"out-of-reach"});

  const Outcome report =
      run("report " + at("far.h5") + " --env " + at("site.h5") + " --model " + at("car.xyz") +
          " --trajectory " + at("far.txt") + " --json -o " + at("far.html"));
  INFO(report.err);
  const json facts = json::parse(report.out);
  CHECK(facts["verdict"] == "undecided");
  CHECK(facts["reasons"] == json{"question-in-doubt"});
  CHECK_THAT(report.err, Contains("undecided, 0 colliding points"));

  CHECK_THAT(run("compare " + at("far.h5") + " " + at("far.h5")).err,
             Contains("its verdict is undecided, because the run warned of out-of-reach"));
  REQUIRE(run(run_text + "--first-pose --force -o " + at("first.h5")).exit_code == 0);
  const Outcome listed = run("conflicts " + at("first.h5") + " --trajectory " + at("far.txt"));
  INFO(listed.err);
  const std::string undecided =
      "the verdict of this result is undecided, because the question is in doubt (out-of-reach)";
  CHECK_THAT(listed.out, Contains("no conflicts, because no point collides\n" + undecided));
  CHECK_THAT(listed.err, Contains("its verdict is undecided"));
  const json listing =
      json::parse(run("conflicts --json " + at("first.h5") + " --trajectory " + at("far.txt")).out);
  CHECK(listing["verdict"] == "undecided");
  CHECK(listing["doubts"] == json{"out-of-reach"});
  const Outcome exported = run("export --json " + at("far.h5") + " -o " + at("far.csv"));
  CHECK_THAT(exported.err, Contains("warning: ") && Contains(undecided));
  CHECK(json::parse(exported.out)["verdict"] == "undecided");

  for (const char* part : {"1", "2"}) {
    const Outcome outcome = run(run_text + "--shard " + part + "/2 --json -o " +
                                at(std::string("part") + part + ".h5"));
    CHECK(json::parse(outcome.out)["verdict"] == "unknown");
    CHECK(json::parse(outcome.out)["reasons"].empty());
  }
  const std::string merge = "merge " + at("part1.h5") + " " + at("part2.h5") + " -o " + at("m.h5");
  const Outcome merged = run(merge + " --fail-on-collision --json");
  CHECK(merged.exit_code == 6);
  CHECK(json::parse(merged.out)["verdict"] == "undecided");
  CHECK(bytes_of(street.folder / "m.h5") == bytes_of(street.folder / "far.h5"));
  CHECK(run(merge + " --fail-on-collision --resume").exit_code == 6);
}

TEST_CASE("an all-clear that was warned of is never repeated without the warnings") {
  const Street street;
  const json report = json::parse(street.run("--radius 0.1 --first-pose --json").out);
  REQUIRE(report["verdict"] == "clear");
  std::set<std::string> codes;
  for (const json& warning : report["warnings"]) codes.insert(warning["code"]);
  REQUIRE(!codes.empty());
  CHECK(json::parse(street.program("info --json out.h5").out)["warned_of"] == json(codes));
  const std::string clause = "but its run warned of " + *codes.begin();
  const Outcome listed = street.program("conflicts out.h5 --trajectory path.csv");
  CHECK_THAT(listed.out, Contains("is clear: ") && Contains(clause));
  CHECK_THAT(street.program("export out.h5 -o p.csv").err, Contains(clause));
  // A result that collides keeps them too.
  const json colliding = json::parse(street.run("--radius 0.3 --force --json").out);
  REQUIRE(colliding["verdict"] == "conflict");
  CHECK(!colliding["warnings"].empty());
  CHECK(json::parse(street.program("info --json out.h5").out)["warnings"] == colliding["warnings"]);
}

TEST_CASE("a least distance is told without the rounding of its coordinates") {
  const Street street;
  put_bytes(street.folder / "car.xyz", "0 0.25000008507 0\n");
  CHECK_THAT(street.run("--radius 0.1 --clearance 0.2").out,
             Contains("the least distance is 0 m at"));
}

TEST_CASE("one colliding point is a conflict, however doubtful the question is") {
  const Street street;
  const Outcome outcome = street.run("--radius 0.3 --json --fail-on-collision");
  CHECK(outcome.exit_code == 1);
  const json report = json::parse(outcome.out);
  CHECK(report["verdict"] == "conflict");
  CHECK(report["reasons"].empty());
}
