// The built program, from a scan to a result.
#include <nlohmann/json.hpp>

#include "clearway/model.hpp"
#include "clearway/trajectory.hpp"
#include "core/query/search_result.hpp"
#include "support/bytes/las_bytes.hpp"
#include "support/catch.hpp"
#include "support/clouds.hpp"
#include "support/engines/brute_force.hpp"
#include "support/result_fixture.hpp"
#include "tools/cli/support/hall.hpp"
#include "tools/cli/support/spawned.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;

TEST_CASE("from a scan to an exported result") {
  const Work work;
  check_refused(work.run("convert hall/environment.las -o site.h5"), 0, "30,000 points");

  const Outcome info = work.run("info site.h5");
  check_outcome(info, 0);
  CHECK(info.err.empty());
  check_says(info.out, "points ... 30000 ... environment.las");
  check_outcome(work.run("verify site.h5"), 0);

  const Outcome run = work.run_hall("site.h5", "out.h5", "--first-pose");
  check_outcome(run, 0);
  CHECK_THAT(run.out, StartsWith("conflict: ") && Contains("; first at pose "));
  check_says(run.err, "environment points collide");
  check_outcome(work.run("verify out.h5"), 0);
  const json result = json_of(work.run("info --json out.h5"));
  check_json(result, R"({"kind": "result", "first_pose": true})");
  CHECK(result["colliding_points"] > 100);

  check_outcome(work.run("export out.h5 -o out.xyz"), 0);
  const std::string lines = work.bytes("out.xyz");
  CHECK(std::count(lines.begin(), lines.end(), '\n') >= result["colliding_points"].get<int>());
  check_outcome(work.run("compare out.h5 out.h5"), 0);
  check_refused(work.run_hall("site.h5", "out.h5"), 2, "out.h5: exists already");
}

TEST_CASE("every subcommand explains itself with units and an example") {
  const Work work;
  const Outcome help = work.run("--help");
  check_outcome(help, 0);
  for (const char* name : {"convert", "run", "export", "compare", "info", "verify", "scene"}) {
    CAPTURE(name);
    check_says(help.out, name);
    const Outcome outcome = work.run(std::string(name) + " --help");
    check_outcome(outcome, 0);
    CHECK(outcome.err.empty());
    check_says(outcome.out, "Example ... clearway " + std::string(name));
    if (std::string(name) != "verify") CHECK_THAT(outcome.out, Contains("metres"));
  }
  const Outcome version = work.run("--version");
  check_outcome(version, 0);
  CHECK_FALSE(version.out.empty());
}

TEST_CASE("wrong usage exits with 2") {
  const Work work;
  const auto files = [&] {
    return std::distance(std::filesystem::directory_iterator(work.folder / ""), {});
  };
  work.run("--version");  // makes the files of what is printed
  const auto before = files();
  work.check({
      {"", 2, "subcommand"},
      {"fly", 2, "no such command"},
      {"bench table -o a.json", 2, "clearway-bench"},
      {"convert a.las", 2, "--output"},
  });
  const std::string convert = "convert hall/environment.las -o a.h5";
  work.check({
      {convert + " --cell-points 63", 2, "63 points a cell: expected 64"},
      {convert + " --memory much", 2, "--memory"},
      {convert + " --memory -1", 2, "--memory"},
      {convert + " --scale -1", 2, "--scale: -1: expected a finite number"},
      {convert + " --scale nan", 2, "--scale"},
      {convert + " --threads 0", 2, "--threads"},
      {convert + " --force=yes", 2, "--force: yes: expected true, false, 1, 0 or no value"},
      {"check hall/site.h5 --between-poses=2", 2, "--between-poses: 2: expected true, false"},
      {"campaign run . --fail-on-collision=0.5", 2, "--fail-on-collision: 0.5: expected true"},
  });
  for (const std::string layout : {"regular", "regular:", "regular:x", "regular:1x", "regular:0",
                                   "regular:nan", "regular:inf", "cubes"}) {
    CAPTURE(layout);
    check_refused(work.run(convert + " --layout " + layout), 2, "regular:SIZE");
  }
  check_refused(work.run("convert - a.las -o a.h5"), 2, "standard input");
  const std::string site = "hall/site.h5";
  for (const std::string radius : {"0", "-1", "x", "nan", "inf"}) {
    CAPTURE(radius);
    check_refused(work.run("run --env " + site +
                           " --model hall/model.ply --trajectory hall/trajectory.txt --radius " +
                           radius + " -o out.h5"),
                  2, "--radius");
  }
  check_refused(work.run_hall(site, "out.h5", "--engine magic"), 2, "--engine");
  CHECK(files() == before);
}

TEST_CASE("bad input exits with 3 and names the file") {
  const Work work;
  work.put("bad.las", "LASF, but no more");
  work.put("bad.txt", "1 2 3 4\n");
  check_refused(work.run("convert bad.las -o a.h5"), 3, "bad.las");
  check_refused(work.run_hall("bad.las", "out.h5"), 3, "bad.las");
  work.check({
      {"info bad.las", 3, "bad.las"},
      {"run --env hall/site.h5 --model bad.las --trajectory hall/trajectory.txt --radius 0.1 -o "
       "out.h5",
       3, "bad.las"},
      {"run --env hall/site.h5 --model hall/model.ply --trajectory bad.txt --radius 0.1 -o out.h5",
       3, "bad.txt"},
  });
  require_success(work.run_hall("hall/site.h5", "result.h5"));
  check_refused(work.run_hall("result.h5", "out.h5"), 3, "not a store");
  check_refused(work.run("compare hall/site.h5 result.h5"), 3, "site.h5");
  CHECK_FALSE(work.has("out.h5"));
}

TEST_CASE("a missing file or folder exits with 4 and is named") {
  const Work work;
  const std::string none = "none.h5";
  check_refused(work.run("info " + none), 4, "none.h5");
  check_refused(work.run("verify " + none), 4, "none.h5");
  check_refused(work.run_hall(none, "out.h5"), 4, "none.h5");
  check_refused(work.run("convert hall/environment.las -o nowhere/a.h5"), 4, "nowhere");
}

TEST_CASE("too little memory exits with 4 and says what would do") {
  const Work work;
  const std::string convert = "convert hall/environment.las -o a.h5";
  check_refused(work.run(convert + " --memory 223M"), 4, "--memory 234881024 is enough");
  check_outcome(work.run(convert + " --memory 224M"), 0);
  check_refused(work.run_hall("hall/site.h5", "out.h5", "--memory 1K"), 4, "needs");
}

TEST_CASE("an output that exists is kept without --force") {
  const Work work;
  work.put("a.h5", "mine");
  check_refused(work.run("convert hall/environment.las -o a.h5"), 2, "--force");
  check_refused(work.run_hall("hall/site.h5", "a.h5"), 2, "--force");
  check_same(work.bytes("a.h5"), "mine");
  check_outcome(work.run_hall("hall/site.h5", "a.h5", "--force"), 0);
  CHECK(work.bytes("a.h5") != "mine");
}

TEST_CASE("an input is not overwritten, --force or not") {
  const Work work;
  const std::string las = work.bytes("hall/environment.las");
  work.put("a.las", las);
  check_refused(work.run("convert --force a.las -o a.las"), 2, "an input too");
  check_same(work.bytes("a.las"), las);
  const std::string site = work.bytes("hall/site.h5");
  work.put("site.h5", site);
  check_refused(work.run_hall("site.h5", "site.h5", "--force"), 2, "an input too");
  check_same(work.bytes("site.h5"), site);
}

TEST_CASE("run --json prints one object with all that was asked for") {
  const Work work;
  const json report = json_of(require_success(work.run_hall("hall/site.h5", "out.h5", "--json")));
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
  check_json(report, R"({"environment_points": 30000, "cells_total": 1})");
  CHECK(report["engine"] == "sweep");
  CHECK(report["bytes_read"]["coordinates"] > 30000);
  CHECK(report["bytes_read"]["sources"] > 0);
  check_json(report["bytes_read"], R"({"classes": 0, "origins": 0})");
}

TEST_CASE("info --json describes a store") {
  const Work work;
  check_json(json_of(work.run("info --json hall/site.h5")), R"({
    "kind": "store", "points": 30000, "layout": "adaptive", "cell_points": 65536,
    "sources": {"0": {"name": "environment.las"}}})");
}

TEST_CASE("the result is the same whatever threads, cells and layout") {
  const Work work;
  require_success(work.run_hall("hall/site.h5", "out.h5", "--first-pose"));
  const std::string expected = work.bytes("out.h5");
  for (const char* threads : {"1", "2"}) {
    require_success(work.run_hall("hall/site.h5", "out.h5",
                                  std::string("--first-pose --force --threads ") + threads));
    check_same(work.bytes("out.h5"), expected);
  }
  for (const std::string options :
       {"--cell-points 1000", "--cell-points 64", "--layout regular:5 --cell-points 1000",
        "--layout regular:0.5 --cell-points 100"}) {
    CAPTURE(options);
    work.succeed("convert --force hall/environment.las -o site.h5 " + options);
    require_success(work.run_hall("site.h5", "laid.h5", "--first-pose --force"));
    // Numbers in warnings can be measured on the blocks of the store, so the bytes may differ.
    check_outcome(work.run("compare out.h5 laid.h5"), 0);
  }
}

TEST_CASE("the result is that of brute force") {
  const Work work;
  require_success(work.run_hall("hall/site.h5", "out.h5", "--first-pose"));
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
    if (first[i] == kNoPose) continue;
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
  work.put("a.las", las.build());
  for (const std::string options : {"", " --scale 0.01", " --layout regular:5"}) {
    CAPTURE(options);
    const std::string end = std::string(" --cell-points 100 --force") + options + " -o ";
    work.succeed("convert a.las" + end + "file.h5");
    require_success(work.run("convert -" + end + "pipe.h5", work.folder / "a.las"));
    const StoreReader file(work.folder / "file.h5"), pipe(work.folder / "pipe.h5");
    CHECK(pipe.fingerprint() == file.fingerprint());
    CHECK(std::equal(pipe.top_tree().begin(), pipe.top_tree().end(), file.top_tree().begin(),
                     file.top_tree().end()));
    CHECK(pipe.metadata().unit == file.metadata().unit);
    CHECK(pipe.metadata().crs_wkt == file.metadata().crs_wkt);
    check_says(pipe.metadata().crs_wkt, "LOCAL_CS");
    CHECK(stored_points(pipe) == stored_points(file));
    CHECK(pipe.metadata().sources == std::vector<SourceFile>{{"-", 0, 0}});
  }
}

TEST_CASE("verify names what is damaged and exits with 1") {
  const Work work;
  std::string bytes = work.bytes("hall/site.h5");
  const std::uint64_t at = StoreReader(work.hall.path("site.h5")).index().address[2] + 100;
  bytes[at] = static_cast<char>(bytes[at] ^ 1);
  work.put("site.h5", bytes);
  check_outcome(work.run("verify site.h5"), 1, kAnything, "cell 0 ... 'z' ... damaged");
  check_refused(work.run_hall("site.h5", "out.h5"), 3, "cell 0");
  CHECK_FALSE(work.has("out.h5"));
  CHECK_FALSE(work.has("out.h5.partial"));
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
