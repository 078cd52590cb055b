// The options of `convert` on faulty inputs.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "support/bytes/las_bytes.hpp"
#include "support/clouds.hpp"
#include "tools/cli/support/hall.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;
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
  put_bytes(work.folder / "a.xyz", rows(100) + "nan 0 0\n");
  const Outcome outcome =
      work.run("convert --json " + work.path("a.xyz") + " -o " + work.path("a.h5"));
  REQUIRE(outcome.exit_code == 0);
  const json report = json::parse(outcome.out);
  CHECK(report["was_finished"] == false);
  CHECK(report["points"] == 100);
  CHECK(report["cells"] == 1);
  CHECK(report["non_finite"] == 1);
  CHECK(report["absent"] == 0);
  CHECK(report["scale"] == json{1e-6, 1e-6, 1e-6});
  CHECK(report["offset"] == json{0.0, 0.0, 1.0});
  CHECK(report["box"]["lo"] == json{0.0, 0.0, 1.5});
  CHECK(report["box"]["hi"] == json{9.75, 49.5, 1.5});
  CHECK(report["largest_change"] < 1e-6);
  CHECK(report["output_bytes"] == fs::file_size(work.folder / "a.h5"));
  CHECK(report["seconds"]["total"] >= report["seconds"]["count"]);
  REQUIRE(report["warnings"].size() == 1);
  CHECK(report["warnings"][0]["code"] == "non-finite-points");
  CHECK(report["warnings"][0]["numbers"]["points"] == 1);
  CHECK_THAT(outcome.err, Contains(report["warnings"][0]["message"].get<std::string>()));
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
  put_bytes(work.folder / "a.las", las.build());
  const std::string end = " --json -o " + work.path("a.h5") + " --force";
  const auto info = [&](const std::string& file) {
    return json::parse(work.run("info --json " + work.path(file)).out);
  };
  for (const bool pipe : {false, true}) {
    INFO((pipe ? "standard input" : "file"));
    const std::string input = pipe ? "-" : work.path("a.las");
    const fs::path from = pipe ? work.folder / "a.las" : fs::path();
    const Outcome left_out = work.run("convert " + input + end, from);
    REQUIRE(left_out.exit_code == 0);
    CHECK_THAT(left_out.err, Contains("50 of 200 points (25 %)") && Contains("--keep-withheld"));
    const json report = json::parse(left_out.out);
    CHECK(report["points"] == 150);
    CHECK(report["non_finite"] == 0);
    CHECK(report["withheld"] == 50);
    CHECK(report["withheld_kept"] == 0);
    CHECK(report["warnings"][0]["code"] == "withheld-points");
    json store = info("a.h5");
    CHECK(store["non_finite_points"] == 0);
    CHECK(store["withheld"]["points"] == 50);
    CHECK(store["withheld"]["kept"] == false);
    CHECK(store["withheld"]["cubes"] > 10);
    CHECK_THAT(work.run("info " + work.path("a.h5")).out, Contains("50 points, left out, in "));

    const Outcome kept = work.run("convert --keep-withheld " + input + end, from);
    CHECK_THAT(kept.err, !Contains("--keep-withheld"));
    CHECK(json::parse(kept.out)["withheld_kept"] == 50);
    store = info("a.h5");
    CHECK(store["points"] == 200);
    CHECK(store["withheld"]["kept"] == true);
  }
  const json scan = info("a.las");
  CHECK(scan["points"] == 200);
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
  put_bytes(work.folder / "grid.txt", grid);
  put_bytes(work.folder / "times.txt", times);
  for (const auto& [name, advice] : {std::pair("grid.txt", std::string("--columns 3,4,5")),
                                     std::pair("times.txt", std::string("--columns 2,3,4"))}) {
    const std::string convert = "convert --force " + work.path(name) + " -o " + work.path("a.h5");
    check_refused(work.run(convert), 3, advice);
    CHECK(work.run(convert + " " + advice).exit_code == 0);
  }
}

TEST_CASE("convert --strict refuses warnings, and is silent where nothing is wrong") {
  const Work work;
  put_bytes(work.folder / "a.xyz", rows(100));
  const std::string convert = "convert --strict " + work.path("a.xyz") + " ";
  CHECK(work.run(convert + "-o " + work.path("a.h5")).exit_code == 0);
  const Outcome twice = work.run(convert + work.path("a.xyz") + " -o " + work.path("b.h5"));
  check_refused(twice, 3, "strict: 1 warning (same-scan)");
  CHECK_THAT(twice.err, Contains("a.xyz is the same file as"));
  CHECK_FALSE(fs::exists(work.folder / "b.h5"));
  CHECK_FALSE(fs::exists(work.folder / "b.h5.partial"));
}

TEST_CASE("a table with numbers in front is refused, and read with --columns") {
  const Work work;
  std::string table, named = "point,north,east,up\n";
  for (int i = 0; i < 20; ++i) {
    const std::string line = std::to_string(i + 1) + ",5." + std::to_string(i) + ",6.5,7.5\n";
    table += line;
    named += line;
  }
  put_bytes(work.folder / "a.csv", table);
  put_bytes(work.folder / "b.csv", named);
  const std::string to = " -o " + work.path("a.h5") + " ";
  const Outcome refused = work.run("convert " + work.path("a.csv") + to);
  check_refused(refused, 3, "a.csv: line 1: looks like a table whose first column is the point's");
  CHECK_THAT(refused.err, Contains("--columns 2,3,4"));
  CHECK(work.run("convert --columns 3,2,4 " + work.path("a.csv") + to).exit_code == 0);
  CHECK(work.run("convert --force --columns east,north,UP " + work.path("b.csv") + to).exit_code ==
        0);
  check_refused(work.run("convert --columns 3,2 " + work.path("a.csv") + to), 2, "columns");
  check_refused(work.run("convert --columns 1,2,3 " + work.hall / "environment.las" + " -o " +
                         work.path("b.h5")),
                2, "no input is a text");
}

TEST_CASE("a trajectory as a scan, and as a model, is refused as what it is") {
  const Work work;
  fs::copy_file(work.hall.path("trajectory.txt"), work.folder / "path.txt");
  check_refused(work.run("convert " + work.path("path.txt") + " -o " + work.path("a.h5")), 3,
                "looks like a trajectory");
  const Outcome run = work.run("run --env " + work.hall / "site.h5" + " --model " +
                               work.path("path.txt") + " --trajectory " + work.path("path.txt") +
                               " --radius 0.1 -o " + work.path("out.h5"));
  check_refused(run, 3, "is a trajectory");
  CHECK_THAT(run.err, !Contains("--columns"));
}

TEST_CASE("one bad file in a folder is refused with the remedy, which leaves it out") {
  const Work work;
  fs::create_directory(work.folder / "scans");
  put_bytes(work.folder / "scans/a.xyz", rows(50));
  put_bytes(work.folder / "scans/b.xyz", rows(70) + "1 2 what\n");
  put_bytes(work.folder / "scans/c.xyz", rows(60));
  const std::string convert = "convert " + work.path("scans") + " -o " + work.path("a.h5");
  check_refused(work.run(convert), 3, "b.xyz: line 71");
  CHECK_THAT(work.run(convert).err, Contains("--skip-unreadable"));
  const Outcome outcome = work.run(convert + " --skip-unreadable --json");
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.err, Contains("1 file is left out") && Contains("b.xyz: line 71"));
  CHECK(json::parse(outcome.out)["points"] == 110);
  CHECK(json::parse(outcome.out)["warnings"][0]["code"] == "skipped-files");
  const Outcome again = work.run(convert + " --skip-unreadable --resume --json");
  CHECK(json::parse(again.out)["was_finished"] == true);
}

TEST_CASE("one point far away is named with its line, and --scale accepts the steps") {
  const Work work;
  put_bytes(work.folder / "a.xyz", rows(100) + "1e9 2 3\n" + rows(10));
  const std::string convert = "convert " + work.path("a.xyz") + " -o " + work.path("a.h5");
  const Outcome refused = work.run(convert);
  check_refused(refused, 3, "line 101: 1e+09 2 3");
  CHECK_THAT(refused.err, Contains("--scale 1 accepts that step"));
  CHECK(work.run(convert + " --scale 1").exit_code == 0);
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
  put_bytes(work.folder / "a.las", las.build());
  put_bytes(work.folder / "p.txt",
            "1000 0 0 0 0 0 0 1\n1001 2 0 0 0 0 0 1\n1002 4 0 0 0 0 1 0\n1003 6 0 0 0 0 1 0\n");
  const std::string convert = "convert " + work.path("a.las") + " -o " + work.path("a.h5") +
                              " --trajectory-format tum --origins-path " + work.path("p.txt");
  const Outcome outcome = work.run(convert + " --lever-arm 50cm,0,1 --json");
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  const json report = json::parse(outcome.out);
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
  CHECK(report["origins"]["distinct"] == 3);
  CHECK(report["origins"]["points_without"] == 1);
  CHECK_THAT(outcome.err, Contains("(adjusted standard GPS time, by the header)") &&
                              Contains("seconds of the GPS week") && Contains("exact"));
  CHECK_THAT(work.run("info " + work.path("a.h5")).out,
             Contains("a path and the GPS times of the points"));
  CHECK(work.run(convert + " --lever-arm 50cm,0,1 --resume").exit_code == 0);
  CHECK(work.run(convert + " --lever-arm 51cm,0,1 --resume").exit_code != 0);
  check_refused(work.run(convert + " --origins x.csv --force"), 2, "one of the two");
  check_refused(
      work.run("convert " + work.path("a.las") + " -o " + work.path("b.h5") + " --lever-arm 1,0,0"),
      2, "lever arm");
  // Of standard input, whose CRS is known before its points, the times are kept too.
  const Outcome piped =
      work.run("convert - -o " + work.path("c.h5") + " --trajectory-format tum --origins-path " +
                   work.path("p.txt") + " --lever-arm 0.5,0,1 --json",
               work.folder / "a.las");
  INFO(piped.err);
  REQUIRE(piped.exit_code == 0);
  CHECK(json::parse(piped.out)["origins"]["hash"] == report["origins"]["hash"]);
}
