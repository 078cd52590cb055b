// What `convert` tells of records of LAS.
#include <nlohmann/json.hpp>

#include "support/bytes/las_bytes.hpp"
#include "support/catch.hpp"
#include "support/clouds.hpp"
#include "tools/cli/support/hall.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;
namespace fs = std::filesystem;

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
