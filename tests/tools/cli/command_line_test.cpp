// The built program, from a scan to a result.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "clearway/model.hpp"
#include "clearway/trajectory.hpp"
#include "core/query/search_result.hpp"
#include "cpu/brute_force.hpp"
#include "support/bytes/las_bytes.hpp"
#include "support/clouds.hpp"
#include "support/result_fixture.hpp"
#include "tools/cli/support/hall.hpp"
#include "tools/cli/support/spawned.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;
using Catch::StartsWith;
using nlohmann::json;

TEST_CASE("from a scan to an exported result") {
  const Work work;
  const Outcome convert =
      work.run("convert " + work.hall / "environment.las" + " -o " + work.path("site.h5"));
  CHECK(convert.exit_code == 0);
  CHECK(convert.out.empty());
  CHECK_THAT(convert.err, Contains("30,000 points"));

  const Outcome info = work.run("info " + work.path("site.h5"));
  CHECK(info.exit_code == 0);
  CHECK(info.err.empty());
  CHECK_THAT(info.out, Contains("points") && Contains("30000") && Contains("environment.las"));
  CHECK(work.run("verify " + work.path("site.h5")).exit_code == 0);

  const Outcome run = work.run_hall(work.path("site.h5"), "out.h5", "--first-pose");
  CHECK(run.exit_code == 0);
  CHECK_THAT(run.out, StartsWith("conflict: ") && Contains("; first at pose "));
  CHECK_THAT(run.err, Contains("environment points collide"));
  CHECK(work.run("verify " + work.path("out.h5")).exit_code == 0);
  const json result = json::parse(work.run("info --json " + work.path("out.h5")).out);
  CHECK(result["kind"] == "result");
  CHECK(result["colliding_points"] > 100);
  CHECK(result["first_pose"] == true);

  CHECK(work.run("export " + work.path("out.h5") + " -o " + work.path("out.xyz")).exit_code == 0);
  const std::string lines = work.bytes("out.xyz");
  CHECK(std::count(lines.begin(), lines.end(), '\n') >= result["colliding_points"].get<int>());
  CHECK(work.run("compare " + work.path("out.h5") + " " + work.path("out.h5")).exit_code == 0);
  CHECK(work.run_hall(work.path("site.h5"), "less.h5", "--radius 0.05 --force").exit_code != 1);
}

TEST_CASE("every subcommand explains itself with units and an example") {
  const Work work;
  const Outcome help = work.run("--help");
  CHECK(help.exit_code == 0);
  for (const char* name : {"convert", "run", "export", "compare", "info", "verify", "scene"}) {
    CAPTURE(name);
    CHECK_THAT(help.out, Contains(name));
    const Outcome outcome = work.run(std::string(name) + " --help");
    CHECK(outcome.exit_code == 0);
    CHECK(outcome.err.empty());
    CHECK_THAT(outcome.out, Contains("Example") && Contains("clearway " + std::string(name)));
    if (std::string(name) != "verify") CHECK_THAT(outcome.out, Contains("metres"));
  }
  const Outcome version = work.run("--version");
  CHECK(version.exit_code == 0);
  CHECK_FALSE(version.out.empty());
}

TEST_CASE("wrong usage exits with 2") {
  const Work work;
  check_refused(work.run(""), 2, "subcommand");
  check_refused(work.run("fly"), 2, "no such command");
  check_refused(work.run("bench table -o a.json"), 2, "clearway-bench");
  check_refused(work.run("convert a.las"), 2, "--output");
  const std::string convert =
      "convert " + work.hall / "environment.las" + " -o " + work.path("a.h5");
  check_refused(work.run(convert + " --cell-points 63"), 2, "63 points a cell: expected 64");
  check_refused(work.run(convert + " --memory much"), 2, "--memory");
  check_refused(work.run(convert + " --memory -1"), 2, "--memory");
  check_refused(work.run(convert + " --scale -1"), 2, "--scale: -1: expected a finite number");
  check_refused(work.run(convert + " --scale nan"), 2, "--scale");
  check_refused(work.run(convert + " --threads 0"), 2, "--threads");
  for (const char* layout : {"regular", "regular:", "regular:x", "regular:1x", "regular:0",
                             "regular:nan", "regular:inf", "cubes"}) {
    CAPTURE(layout);
    check_refused(work.run(convert + " --layout " + layout), 2, "regular:SIZE");
  }
  check_refused(work.run("convert - a.las -o " + work.path("a.h5")), 2, "standard input");
  const std::string site = work.hall / "site.h5";
  for (const char* radius : {"0", "-1", "x", "nan", "inf"}) {
    CAPTURE(radius);
    check_refused(work.run("run --env " + site + " --model " + work.hall / "model.ply" +
                           " --trajectory " + work.hall / "trajectory.txt" + " --radius " + radius +
                           " -o " + work.path("out.h5")),
                  2, "--radius");
  }
  check_refused(work.run_hall(site, "out.h5", "--engine magic"), 2, "--engine");
  CHECK(std::filesystem::is_empty(work.folder / "") == false);  // only the program's logs are in it
  CHECK_FALSE(std::filesystem::exists(work.folder / "a.h5"));
  CHECK_FALSE(std::filesystem::exists(work.folder / "out.h5"));
}

TEST_CASE("bad input exits with 3 and names the file") {
  const Work work;
  put_bytes(work.folder / "bad.las", "LASF, but no more");
  put_bytes(work.folder / "bad.txt", "1 2 3 4\n");
  check_refused(work.run("convert " + work.path("bad.las") + " -o " + work.path("a.h5")), 3,
                "bad.las");
  check_refused(work.run_hall(work.path("bad.las"), "out.h5"), 3, "bad.las");
  check_refused(work.run("info " + work.path("bad.las")), 3, "bad.las");
  check_refused(work.run("run --env " + work.hall / "site.h5" + " --model " + work.path("bad.las") +
                         " --trajectory " + work.hall / "trajectory.txt" + " --radius 0.1 -o " +
                         work.path("out.h5")),
                3, "bad.las");
  check_refused(
      work.run("run --env " + work.hall / "site.h5" + " --model " + work.hall / "model.ply" +
               " --trajectory " + work.path("bad.txt") + " --radius 0.1 -o " + work.path("out.h5")),
      3, "bad.txt");
  REQUIRE(work.run_hall(work.hall / "site.h5", "result.h5").exit_code == 0);
  check_refused(work.run_hall(work.path("result.h5"), "out.h5"), 3, "not a store");
  check_refused(work.run("compare " + work.hall / "site.h5" + " " + work.path("result.h5")), 3,
                "site.h5");
  CHECK_FALSE(std::filesystem::exists(work.folder / "out.h5"));
}

TEST_CASE("a missing file or folder exits with 4 and is named") {
  const Work work;
  const std::string none = work.path("none.h5");
  check_refused(work.run("info " + none), 4, "none.h5");
  check_refused(work.run("verify " + none), 4, "none.h5");
  check_refused(work.run_hall(none, "out.h5"), 4, "none.h5");
  check_refused(
      work.run("convert " + work.hall / "environment.las" + " -o " + work.path("nowhere/a.h5")), 4,
      "nowhere");
}

TEST_CASE("too little memory exits with 4 and says what would do") {
  const Work work;
  const std::string convert =
      "convert " + work.hall / "environment.las" + " -o " + work.path("a.h5");
  check_refused(work.run(convert + " --memory 223M"), 4, "--memory 234881024 is enough");
  CHECK(work.run(convert + " --memory 224M").exit_code == 0);
  check_refused(work.run_hall(work.hall / "site.h5", "out.h5", "--memory 1K"), 4, "needs");
}

TEST_CASE("an output that exists is kept without --force") {
  const Work work;
  put_bytes(work.folder / "a.h5", "mine");
  check_refused(work.run("convert " + work.hall / "environment.las" + " -o " + work.path("a.h5")),
                2, "--force");
  check_refused(work.run_hall(work.hall / "site.h5", "a.h5"), 2, "--force");
  CHECK(work.bytes("a.h5") == "mine");
  CHECK(work.run_hall(work.hall / "site.h5", "a.h5", "--force").exit_code == 0);
  CHECK(work.bytes("a.h5") != "mine");
}

TEST_CASE("an input is not overwritten, --force or not") {
  const Work work;
  const std::string las = bytes_of(work.hall.path("environment.las"));
  put_bytes(work.folder / "a.las", las);
  check_refused(work.run("convert --force " + work.path("a.las") + " -o " + work.path("a.las")), 2,
                "an input too");
  CHECK(work.bytes("a.las") == las);
  const std::string site = bytes_of(work.hall.path("site.h5"));
  put_bytes(work.folder / "site.h5", site);
  check_refused(work.run_hall(work.path("site.h5"), "site.h5", "--force"), 2, "an input too");
  CHECK(work.bytes("site.h5") == site);
}

TEST_CASE("run --json prints one object with all that was asked for") {
  const Work work;
  const Outcome outcome = work.run_hall(work.hall / "site.h5", "out.h5", "--json");
  REQUIRE(outcome.exit_code == 0);
  const json report = json::parse(outcome.out);
  for (const char* key :
       {"environment_points", "colliding_points", "engine", "device", "cells_total", "cells_read",
        "bytes_read", "peak_host_bytes", "peak_device_bytes", "seconds"}) {
    CAPTURE(key);
    CHECK(report.contains(key));
  }
  for (const char* key : {"total", "context", "context_wait", "plan", "field", "read", "upload",
                          "compute", "swept", "beams", "write", "end_wait"}) {
    CAPTURE(key);
    CHECK(report["seconds"][key].is_number());
  }
  CHECK(report["environment_points"] == 30000);
  CHECK(report["engine"] == (report["poses"] <= 200 ? "kdtree" : "sweep"));
  CHECK(report["cells_total"] == 1);
  CHECK(report["bytes_read"] > 30000);
}

TEST_CASE("info --json describes a store") {
  const Work work;
  const json info = json::parse(work.run("info --json " + work.hall / "site.h5").out);
  CHECK(info["kind"] == "store");
  CHECK(info["points"] == 30000);
  CHECK(info["layout"] == "adaptive");
  CHECK(info["cell_points"] == 65536);
  CHECK(info["sources"][0]["name"] == "environment.las");
}

TEST_CASE("the result is the same whatever threads, cells and layout") {
  const Work work;
  REQUIRE(work.run_hall(work.hall / "site.h5", "out.h5", "--first-pose").exit_code == 0);
  const std::string expected = work.bytes("out.h5");
  for (const char* threads : {"1", "2"}) {
    REQUIRE(work.run_hall(work.hall / "site.h5", "out.h5",
                          std::string("--first-pose --force --threads ") + threads)
                .exit_code == 0);
    CHECK(work.bytes("out.h5") == expected);
  }
  for (const char* options :
       {"--cell-points 1000", "--cell-points 64", "--layout regular:5 --cell-points 1000",
        "--layout regular:0.5 --cell-points 100"}) {
    CAPTURE(options);
    REQUIRE(work.run("convert --force " + work.hall / "environment.las" + " -o " +
                     work.path("site.h5") + " " + options)
                .exit_code == 0);
    REQUIRE(work.run_hall(work.path("site.h5"), "laid.h5", "--first-pose --force").exit_code == 0);
    // Numbers in warnings can be measured on the blocks of the store, so the bytes may differ.
    CHECK(work.run("compare " + work.path("out.h5") + " " + work.path("laid.h5")).exit_code == 0);
  }
}

TEST_CASE("the result is that of brute force") {
  const Work work;
  REQUIRE(work.run_hall(work.hall / "site.h5", "out.h5", "--first-pose").exit_code == 0);
  const StoreReader store(work.hall.path("site.h5"));
  std::vector<Vec3> environment;
  for (const Quantum& q : points_by_source(store)) {
    environment.push_back(position(store.quantisation(), q[0], q[1], q[2]));
  }
  const auto model = read_model_points(work.hall.path("model.ply"));
  const auto poses = read_trajectory(work.hall.path("trajectory.txt"), {});
  const auto first = brute_force_first_poses(environment, {model, poses, {0.1, true}});
  Collisions expected;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (first[i] == HitSet::kNever) continue;
    expected.source.push_back(i);
    expected.xyz.push_back(environment[i]);
    expected.first_pose.push_back(first[i]);
  }
  CHECK(expected.size() > 100);
  CHECK(same_rows(read_rows(ResultReader(work.folder / "out.h5")), expected));
}

TEST_CASE("standard input makes the store of the file but for the description of its source") {
  const Work work;
  LasBytes las;
  las.minor = 4;
  las.format = 6;
  las.global_encoding = 16;
  las.points = cube_cloud(5000, -3000, 3000, 1);
  las.evlrs = {{"LASF_Projection", 2112, R"(LOCAL_CS["m",UNIT["metre",1]])"}};
  put_bytes(work.folder / "a.las", las.build());
  for (const char* options : {"", " --scale 0.01", " --layout regular:5"}) {
    CAPTURE(options);
    const std::string end = std::string(" --cell-points 100 --force") + options + " -o ";
    REQUIRE(work.run("convert " + work.path("a.las") + end + work.path("file.h5")).exit_code == 0);
    REQUIRE(work.run("convert -" + end + work.path("pipe.h5"), work.folder / "a.las").exit_code ==
            0);
    const StoreReader file(work.folder / "file.h5"), pipe(work.folder / "pipe.h5");
    CHECK(pipe.fingerprint() == file.fingerprint());
    CHECK(std::equal(pipe.top_tree().begin(), pipe.top_tree().end(), file.top_tree().begin(),
                     file.top_tree().end()));
    CHECK(pipe.metadata().unit == file.metadata().unit);
    CHECK(pipe.metadata().crs_wkt == file.metadata().crs_wkt);
    CHECK_THAT(pipe.metadata().crs_wkt, Contains("LOCAL_CS"));
    CHECK(stored_points(pipe) == stored_points(file));
    CHECK(pipe.metadata().sources == std::vector<SourceFile>{{"-", 0, 0}});
  }
}

TEST_CASE("verify names what is damaged and exits with 1") {
  const Work work;
  std::string bytes = bytes_of(work.hall.path("site.h5"));
  const std::uint64_t at = StoreReader(work.hall.path("site.h5")).index().address[2] + 100;
  bytes[at] = static_cast<char>(bytes[at] ^ 1);
  put_bytes(work.folder / "site.h5", bytes);
  const Outcome outcome = work.run("verify " + work.path("site.h5"));
  CHECK(outcome.exit_code == 1);
  CHECK_THAT(outcome.out, Contains("cell 0") && Contains("'z'") && Contains("damaged"));
  check_refused(work.run_hall(work.path("site.h5"), "out.h5"), 3, "cell 0");
  CHECK_FALSE(std::filesystem::exists(work.folder / "out.h5"));
  CHECK_FALSE(std::filesystem::exists(work.folder / "out.h5.partial"));
}

#ifndef CLEARWAY_SANITIZED  // sanitizers take memory of their own
TEST_CASE("a conversion stays within --memory") {
  const Work work;
  write_las(work.folder / "a.las", cube_cloud(4'500'000, -1000000, 1000000, 1));
  const std::uint64_t peak =
      peak_memory_of({"convert", (work.folder / "a.las").string(), "-o",
                      (work.folder / "a.h5").string(), "--memory", "224M", "--threads", "2"});
  CHECK(peak < (std::uint64_t{224} << 20));
}
#endif
