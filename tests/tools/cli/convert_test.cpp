// The options of `convert` on faulty inputs.
#include <nlohmann/json.hpp>

#include "support/bytes/las_bytes.hpp"
#include "support/catch.hpp"
#include "support/clouds.hpp"
#include "tools/cli/support/hall.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

std::string rows(int count, const std::string& in_front = "") {
  std::string text;
  for (int i = 0; i < count; ++i) {
    text += in_front + std::to_string(0.25 * (i % 40)) + " " + std::to_string(0.5 * i) + " 1.5\n";
  }
  return text;
}

}  // namespace

TEST_CASE("convert --json tells what was made") {
  const Work work;
  work.put("a.xyz", rows(100) + "nan 0 0\n");
  const Outcome outcome = work.succeed("convert --json a.xyz -o a.h5");
  const json report = json_of(outcome);
  check_json(report, R"({
    "was_finished": false, "points": 100, "cells": 1, "non_finite": 1, "absent": 0,
    "scale": [1e-6, 1e-6, 1e-6], "offset": [0.0, 0.0, 1.0],
    "box": {"lo": [0.0, 0.0, 1.5], "hi": [9.75, 49.5, 1.5]}})");
  CHECK(report["largest_change"] < 1e-6);
  CHECK(report["output_bytes"] == fs::file_size(work.folder / "a.h5"));
  CHECK(report["seconds"]["total"] >= report["seconds"]["count"]);
  REQUIRE(report["warnings"].size() == 1);
  check_json(report, R"({
    "warnings": {"0": {"code": "non-finite-points", "numbers": {"points": 1}}}})");
  check_says(outcome.err, report["warnings"][0]["message"].get<std::string>());
}

TEST_CASE("withheld points are told by convert and info, from files and from standard input") {
  const Work work;
  LasBytes las;
  las.minor = 4;
  las.format = 6;
  las.points = cube_cloud(200, -3000, 3000, 1);
  for (unsigned i = 0; i < 200; ++i) {
    las.bytes_of_flags.push_back(i % 4 == 3 ? 4 : i % 4 == 2 ? 9 : 0);
  }
  work.put("a.las", las.build());
  const std::string end = " --json -o a.h5 --force";
  const auto info = [&](const std::string& file) {
    return json_of(work.run("info --json " + file));
  };
  for (const bool pipe : {false, true}) {
    INFO((pipe ? "standard input" : "file"));
    const std::string input = pipe ? "-" : "a.las";
    const fs::path from = pipe ? work.folder / "a.las" : fs::path();
    const Outcome left_out = require_success(work.run("convert " + input + end, from));
    check_says(left_out.err, "50 of 200 points (25 %) ... --keep-withheld");
    check_json(json_of(left_out), R"({
      "points": 150, "non_finite": 0, "withheld": 50, "withheld_kept": 0,
      "warnings": {"0": {"code": "withheld-points"}}})");
    json store = info("a.h5");
    check_json(store, R"({"non_finite_points": 0, "withheld": {"points": 50, "kept": false}})");
    CHECK(store["withheld"]["cubes"] > 10);
    check_says(work.run("info a.h5").out, "50 points, left out, in ");

    const Outcome kept = work.run("convert --keep-withheld " + input + end, from);
    check_lacks(kept.err, "--keep-withheld");
    check_json(json_of(kept), R"({"withheld_kept": 50})");
    store = info("a.h5");
    check_json(store, R"({"points": 200, "withheld": {"kept": true}})");
  }
  const json scan = info("a.las");
  check_json(scan, R"({"points": 200})");
  CHECK(scan["flags"] ==
        json{{"synthetic", 50}, {"key_point", 0}, {"withheld", 50}, {"overlap", 50}});
}

TEST_CASE("a table whose first columns are no coordinates is refused with columns that read it") {
  const Work work;
  std::string grid, times;
  for (int i = 0; i < 40; ++i) {
    const std::string place = " " + std::to_string(0.25 * (i % 7)) + " " +
                              std::to_string(0.5 * (i * i % 11)) + " " +
                              std::to_string(1.5 + i % 3);
    grid += std::to_string(i / 8) + " " + std::to_string(i % 8) + place + "\n";
    times += std::to_string(345600.25 + 0.01 * i) + place + "\n";
  }
  work.put("grid.txt", grid);
  work.put("times.txt", times);
  using Texts = std::array<std::string, 2>;
  for (const auto& [name, advice] :
       {Texts{"grid.txt", "--columns 3,4,5"}, Texts{"times.txt", "--columns 2,3,4"}}) {
    const std::string convert = "convert --force " + name + " -o a.h5";
    check_refused(work.run(convert), 3, advice);
    check_outcome(work.run(convert + " " + advice), 0);
  }
}

TEST_CASE("convert --strict refuses warnings, and is silent where nothing is wrong") {
  const Work work;
  work.put("a.xyz", rows(100));
  const std::string convert = "convert --strict a.xyz ";
  check_outcome(work.run(convert + "-o a.h5"), 0);
  check_refused(work.run(convert + "a.xyz -o b.h5"), 3,
                "a.xyz is the same file as ... strict: 1 warning (same-scan)");
  CHECK_FALSE(work.has("b.h5"));
  CHECK_FALSE(work.has("b.h5.partial"));
}

TEST_CASE("a table with numbers in front is refused, and read with --columns") {
  const Work work;
  std::string table, named = "point,north,east,up\n";
  for (int i = 0; i < 20; ++i) {
    const std::string line = std::to_string(i + 1) + ",5." + std::to_string(i) + ",6.5,7.5\n";
    table += line;
    named += line;
  }
  work.put("a.csv", table);
  work.put("b.csv", named);
  const std::string to = " -o a.h5 ";
  work.check({
      {"convert a.csv" + to, 3,
       "a.csv: line 1: looks like a table whose first column is the point's ... --columns 2,3,4"},
      {"convert --columns 3,2,4 a.csv" + to, 0},
      {"convert --force --columns east,north,UP b.csv" + to, 0},
      {"convert --columns 3,2 a.csv" + to, 2, "columns"},
      {"convert --columns 1,2,3 hall/environment.las -o b.h5", 2, "no input is a text"},
  });
}

TEST_CASE("a trajectory as a scan, and as a model, is refused as what it is") {
  const Work work;
  fs::copy_file(work.hall.path("trajectory.txt"), work.folder / "path.txt");
  check_refused(work.run("convert path.txt -o a.h5"), 3, "looks like a trajectory");
  const Outcome run = work.run(
      "run --env hall/site.h5 --model path.txt --trajectory path.txt --radius 0.1 -o out.h5");
  check_refused(run, 3, "is a trajectory");
  check_lacks(run.err, "--columns");
}

TEST_CASE("one bad file in a folder is refused with the remedy, which leaves it out") {
  const Work work;
  fs::create_directory(work.folder / "scans");
  work.put("scans/a.xyz", rows(50));
  work.put("scans/b.xyz", rows(70) + "1 2 what\n");
  work.put("scans/c.xyz", rows(60));
  const std::string convert = "convert scans -o a.h5";
  check_refused(work.run(convert), 3, "b.xyz: line 71");
  check_says(work.run(convert).err, "--skip-unreadable");
  check_json(json_of(check_outcome(work.run(convert + " --skip-unreadable --json"), 0,
                                   "1 file is left out ... b.xyz: line 71")),
             R"({"points": 110, "warnings": {"0": {"code": "skipped-files"}}})");
  check_json(json_of(work.run(convert + " --skip-unreadable --resume --json")),
             R"({"was_finished": true})");
}

TEST_CASE("one point far away is named with its line, and --scale accepts the steps") {
  const Work work;
  work.put("a.xyz", rows(100) + "1e9 2 3\n" + rows(10));
  const std::string convert = "convert a.xyz -o a.h5";
  check_refused(work.run(convert), 3, "line 101: 1000000000 2 3 ... --scale 1 accepts that step");
  check_outcome(work.run(convert + " --scale 1"), 0);
}

TEST_CASE("convert --origins-path gives a moving scanner's points their origins, and says how") {
  const Work work;
  LasBytes las;
  las.format = 6;
  las.minor = 4;
  las.global_encoding = 1;
  las.scale = {0.001, 0.001, 0.001};
  las.offset = {0, 0, 0};
  las.points = {{5000, 0, 0}, {6000, 0, 0}, {7000, 0, 0}, {8000, 0, 0}};
  // 2286 weeks after 1980-01-06, less 10^9.
  const double sunday = 2286 * 604800.0 - 1e9;
  las.times = {sunday + 1000.25, sunday + 1001, sunday + 1002, sunday + 1003.5};
  work.put("a.las", las.build());
  work.put("p.txt",
           "1000 0 0 0 0 0 0 1\n1001 2 0 0 0 0 0 1\n1002 4 0 0 0 0 1 0\n1003 6 0 0 0 0 1 0\n");
  const std::string convert = "convert a.las -o a.h5 --trajectory-format tum --origins-path p.txt";
  const Outcome outcome = work.succeed(convert + " --lever-arm 50cm,0,1 --json");
  const json report = json_of(outcome);
  CHECK(report["origins_path"] == json{{"point_clock", "adjusted"},
                                       {"path_clock", "week-seconds"},
                                       {"first_point", las.times[0]},
                                       {"last_point", las.times[3]},
                                       {"first_pose", 1000.0},
                                       {"last_pose", 1003.0},
                                       {"shifts", {-sunday}},
                                       {"before", 0},
                                       {"after", 1},
                                       {"in_gaps", 0},
                                       {"without_time", 0}});
  check_json(report, R"({"origins": {"distinct": 3, "points_without": 1}})");
  check_says(outcome.err,
             "(adjusted standard GPS time, by the header) ... seconds of the GPS week ... exact");
  check_says(work.run("info a.h5").out, "a path and the GPS times of the points");
  check_outcome(work.run(convert + " --lever-arm 50cm,0,1 --resume"), 0);
  CHECK(work.run(convert + " --lever-arm 51cm,0,1 --resume").exit_code != 0);
  check_refused(work.run(convert + " --origins x.csv --force"), 2, "one of the two");
  check_refused(work.run("convert a.las -o b.h5 --lever-arm 1,0,0"), 2, "lever arm");
  // Of standard input, whose CRS is known before its points, the times are kept too.
  const Outcome piped = require_success(work.run(
      "convert - -o c.h5 --trajectory-format tum --origins-path p.txt --lever-arm 0.5,0,1 --json",
      work.folder / "a.las"));
  CHECK(json_of(piped)["origins"]["hash"] == report["origins"]["hash"]);
}
