// The built program clearway-bench: its options, its files, and how it continues an experiment.
#include <catch2/catch.hpp>
#include <fstream>

#include "bench/measure/work_folder.hpp"
#include "tools/bench/experiment.hpp"

using namespace clearway::test;
using Catch::Contains;

TEST_CASE("an experiment that was stopped goes on where it was") {
  const Experiment threads("threads");
  REQUIRE(threads.run().exit_code == 0);
  Json figures = threads.figures();
  const std::size_t cases = figures["cases"].size();
  REQUIRE(cases > 2);
  for (const Json& one : figures["cases"]) CHECK(one["runs"].size() == 2);
  const Json first = figures["cases"][0];
  figures["cases"] = Json::array({first});
  threads.write(figures);
  const Outcome refused = threads.run();
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, Contains("--resume"));
  REQUIRE(threads.run("--resume").exit_code == 0);
  CHECK(threads.figures()["cases"].size() == cases);
  CHECK(threads.figures()["cases"][0] == first);
}

TEST_CASE("figures of another experiment or size, or of something else, are not gone on with") {
  const Experiment threads("threads");
  threads.write({{"experiment", "table"}, {"cases", Json::array()}});
  const Outcome another = threads.run("--resume");
  CHECK(another.exit_code == 2);
  CHECK_THAT(another.err, Contains("differs in experiment: table in the file, threads now"));
  for (const std::string odd : {"[1]", R"({"cases": [1]})", R"({"cases": [{}]})"}) {
    threads.write(Json::parse(odd));
    CHECK(threads.run("--resume").exit_code == 3);
  }
  std::ofstream(threads.file()) << "{";
  CHECK(threads.run("--resume").exit_code == 3);
}

TEST_CASE("a run that exceeds the limit has failed, and the experiment goes on") {
  const Experiment datasets("datasets");
  REQUIRE(datasets.run("--scenes hall --limit 1").exit_code == 0);
  const std::size_t cases = datasets.figures()["cases"].size();
  CHECK(cases == 3);
  CHECK(datasets.run("--scenes hall --memory abc").exit_code == 2);
}

TEST_CASE("what a smaller limit has stopped is measured anew, in its place") {
  const Experiment datasets("datasets");
  const std::string options = "--scenes hall --resume --limit ";
  REQUIRE(datasets.run(options + "20").exit_code == 0);
  Json figures = datasets.figures();
  CHECK(figures["parameters"]["limit"] == 20);
  // The second case is in the present form; the last one and the parameters are in the earlier
  // form.
  figures["parameters"].erase("limit");
  for (const std::size_t i : {1, 2}) figures["cases"][i]["runs"] = Json::array();
  figures["cases"][1]["failed"] = {{"after_seconds", 21.5}, {"limit", 20}};
  figures["cases"][2]["failed"] = {{"after_seconds", 21.5}};
  datasets.write(figures);
  REQUIRE(datasets.run(options + "20").exit_code == 0);
  CHECK(datasets.figures()["cases"] == figures["cases"]);
  for (const auto& [limit, anew] : {std::pair{"21", 1}, {"22", 2}}) {
    REQUIRE(datasets.run(options + limit).exit_code == 0);
    const Json now = datasets.figures();
    CHECK(now["parameters"]["limit"] == std::stod(limit));
    REQUIRE(now["cases"].size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
      CAPTURE(limit, i);
      CHECK(now["cases"][i]["key"] == figures["cases"][i]["key"]);
      const bool stopped = static_cast<int>(i) > anew;
      CHECK(now["cases"][i].contains("failed") == stopped);
      CHECK(now["cases"][i]["runs"].size() == (stopped ? 0 : 2));
    }
  }
}

TEST_CASE("the parameter that differs from the file's is named with both values") {
  const Experiment datasets("datasets");
  REQUIRE(datasets.run("--scenes hall").exit_code == 0);
  const std::pair<std::string, std::string> differences[] = {
      {"--scenes hall --device-memory 3G", "differs in --device-memory: 2G in the file, 3G now"},
      {"--scenes mine,hall", "differs in --scenes: hall in the file, mine,hall now"}};
  for (const auto& [options, difference] : differences) {
    const Outcome refused = datasets.run(options + " --resume");
    CHECK(refused.exit_code == 2);
    CHECK_THAT(refused.err, Contains(difference));
  }
  Json figures = datasets.figures();
  figures["parameters"].erase("repetitions");
  datasets.write(figures);
  const Outcome older = datasets.run("--scenes hall --resume");
  CHECK(older.exit_code == 2);
  CHECK_THAT(older.err, Contains("differs in --repetitions: nothing in the file, 2 now"));
}

TEST_CASE("scenes are chosen where an experiment is about any") {
  const Experiment scaling("scaling");
  const Outcome refused = scaling.run("--scenes hall");
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, Contains("--scenes is for table, datasets, equality"));
  CHECK_FALSE(std::filesystem::exists(scaling.file()));
}

TEST_CASE("a work folder is of one bench at a time") {
  const Experiment datasets("datasets");
  {
    const clearway::bench::WorkFolder taken(datasets.work());
    const Outcome refused = datasets.run("--scenes hall");
    CHECK(refused.exit_code == 4);
    CHECK_THAT(refused.err, Contains("another clearway-bench uses it"));
    CHECK_FALSE(std::filesystem::exists(datasets.file()));
  }
  CHECK(datasets.run("--scenes hall").exit_code == 0);
}

TEST_CASE("a work folder of another program is refused, whatever it holds") {
  const Experiment datasets("datasets");
  REQUIRE(datasets.run("--scenes hall").exit_code == 0);
  const auto note = datasets.work() / "made-by.json";
  Json program = Json::parse(bytes_of(note));
  const Json header = datasets.figures()["clearway"];
  for (const char* name : {"version", "commit", "build"}) CHECK(program[name] == header[name]);
  const bool clean = !clearway::bench::may_have_changed(program);
  const Outcome resumed = datasets.run("--scenes hall --resume");
  CHECK(resumed.exit_code == 0);
  const std::string changed = "but the source may have changed";
  CHECK((resumed.err.find(changed) == std::string::npos) == clean);
  program["commit"] = "0123456789ab";
  std::ofstream(note) << program;
  const Outcome refused = datasets.run("--scenes hall --force");
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, Contains("commit 0123456789ab") &&
                              Contains(header["commit"].get<std::string>()) &&
                              Contains("another --work or remove the folder"));
  std::filesystem::remove(note);
  const Outcome adopted = datasets.run("--scenes hall --force");
  CHECK(adopted.exit_code == 0);
  CHECK_THAT(adopted.err, Contains("scenes and stores of an unknown program are used"));
}

TEST_CASE("a failure that says nothing of the method ends the experiment") {
  const Experiment scaling("scaling");
  std::filesystem::create_directories(scaling.work() / "result.h5");
  const Outcome ended = scaling.run();
  CHECK(ended.exit_code == 4);
  CHECK_THAT(ended.err, Contains("kdtree cpu/poses/100") && Contains("is a directory"));
  CHECK(scaling.figures()["cases"].empty());
}

TEST_CASE("another clearway is measured where it is named") {
  const Experiment datasets("datasets", 1);
  const Outcome none = datasets.run("--scenes hall --program /dev/null");
  CHECK(none.exit_code == 2);
  CHECK_THAT(none.err, Contains("--program"));
  const Outcome done = datasets.run("--scenes hall --cold --program '" CLEARWAY_PROGRAM "'");
  CAPTURE(done.err);
  CHECK(done.exit_code == 0);
  const Json program = datasets.figures()["clearway"];
  CHECK(program["build"] == CLEARWAY_PROGRAM);
  CHECK(program["commit"] == "unknown");
  CHECK(datasets.figures()["parameters"]["cold"] == true);
}

TEST_CASE("stages and peers print one JSON object") {
  const Experiment scene("datasets", 1);
  REQUIRE(scene.run("--scenes hall").exit_code == 0);
  const auto files = scene.work() / "hall-smoke";
  const ScratchFolder folder;
  const std::string query = " --env " + quoted(scene.work() / "hall-smoke.h5") + " --model " +
                            quoted(files / "model.ply") + " --trajectory " +
                            quoted(files / "trajectory.txt");
  const Outcome stages = run_program_at(CLEARWAY_BENCH_PROGRAM, folder, "stages --cold" + query);
  CAPTURE(stages.err);
  REQUIRE(stages.exit_code == 0);
  CHECK(Json::parse(stages.out)["cells_read"] == 1);
  const Outcome help = run_program_at(CLEARWAY_BENCH_PROGRAM, folder, "--help");
  if (help.out.find("nanoflann") == std::string::npos) return;  // the build did not find nanoflann
  const Outcome peers = run_program_at(CLEARWAY_BENCH_PROGRAM, folder, "peers" + query);
  CAPTURE(peers.err);
  REQUIRE(peers.exit_code == 0);
  CHECK(Json::parse(peers.out)["differing_points"] == 0);
}
