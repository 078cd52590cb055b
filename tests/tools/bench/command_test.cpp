// The built program clearway-bench, on scenes of a few thousand points.
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "bench/measure/work_folder.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway::test;
using Catch::Contains;
using Json = nlohmann::ordered_json;

namespace {

class Experiment {
 public:
  explicit Experiment(const std::string& name, int repetitions = 2)
      : name_(name), repetitions_(repetitions) {}

  Outcome run(const std::string& more = "") const {
    return run_program_at(CLEARWAY_BENCH_PROGRAM, folder_,
                          name_ + " --size smoke --device cpu --repetitions " +
                              std::to_string(repetitions_) + " -o " + quoted(file()) + " --work " +
                              quoted(work()) + " " + more);
  }
  std::filesystem::path work() const { return folder_ / "work"; }
  std::filesystem::path file() const { return folder_ / "figures.json"; }
  Json figures() const { return Json::parse(bytes_of(file())); }
  void write(const Json& figures) const { std::ofstream(file()) << figures.dump(); }

 private:
  std::string name_;
  int repetitions_;
  ScratchFolder folder_;
};

}  // namespace

TEST_CASE("table: every exact engine finds the same points") {
  const Experiment table("table");
  const Outcome done = table.run();
  REQUIRE(done.exit_code == 0);
  const Json figures = table.figures();
  CHECK(figures["experiment"] == "table");
  CHECK(figures["machine"]["cores"] > 0);
  CHECK_FALSE(figures["clearway"]["commit"].get<std::string>().empty());
  std::set<std::string> scenes;
  for (const Json& one : figures["cases"]) {
    CAPTURE(one["key"]);
    scenes.insert(one["parameters"]["scene"]);
    CHECK(one["runs"].size() == 1);
    CHECK(one["runs"][0]["environment_points"] == 20'000);
    CHECK(one["runs"][0]["wall_seconds"] > 0);
    if (one["parameters"]["exact"]) CHECK(one["findings"]["equal"]);
  }
  CHECK(scenes.size() == 4);
}

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
  // The second case as it is kept now, the last one and the parameters as they were before.
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

TEST_CASE("grid: its regular layouts say how many points a chunk has") {
  const Experiment grid("grid", 1);
  REQUIRE(grid.run().exit_code == 0);
  std::set<std::string> varied;
  const Json figures = grid.figures();
  for (const Json& one : figures["cases"]) {
    CAPTURE(one["key"]);
    const Json& parameters = one["parameters"];
    varied.insert(parameters["vary"]);
    CHECK(one["runs"].size() == 1);
    CHECK(parameters.contains("chunk_points") == (parameters["vary"] == "regular layout"));
  }
  CHECK(varied.size() == 3);
}

TEST_CASE("accuracy: exact engines err nowhere, the others say where") {
  const Experiment accuracy("accuracy");
  const Outcome done = accuracy.run("--limit 4");
  CAPTURE(done.err);
  REQUIRE(done.exit_code == 0);
  std::set<std::string> methods;
  Json figures = accuracy.figures();
  for (const Json& one : figures["cases"]) {
    CAPTURE(one["key"]);
    const std::string method = one["parameters"]["method"];
    methods.insert(method);
    if (one.contains("failed")) {
      CHECK(one["failed"]["limit"] == 4);
      const std::string key = one["key"];
      CHECK_THAT(done.err, Contains("warning: " + key + ": counted as failed: stopped after"));
      continue;
    }
    const Json& wrong = one["findings"];
    if (method == "exact") CHECK(wrong["false_hits"].get<int>() + wrong["misses"].get<int>() == 0);
    if (method == "tolerance") {
      const double tolerance = std::stod(one["parameters"]["value"].get<std::string>());
      CHECK(wrong["largest_distance"].get<double>() <= tolerance);
      CHECK(wrong["beyond"] == 0);
    }
  }
  CHECK(methods.size() == 8);
  REQUIRE(figures["cases"][1]["key"] == "exact/sweep cpu/\"\"");
  figures["cases"][1]["findings"]["misses"] = 1;
  accuracy.write(figures);
  const Outcome wrong = accuracy.run("--limit 4 --resume");
  CHECK(wrong.exit_code != 0);
  CHECK_THAT(wrong.err, Contains("engines that decide exactly are wrong: exact/sweep cpu/"));
}

TEST_CASE("equality: counts and writes what differs from the sweep on the CPU") {
  const Experiment equality("equality", 1);
  const Outcome done = equality.run("--scenes hall");
  CAPTURE(done.err);
  REQUIRE(done.exit_code == 0);
  CHECK_THAT(done.out, Contains("12 runs: 0 differ") && Contains("0 took more"));
  Json figures = equality.figures();
  CHECK(figures["cases"].size() == 13);
  CHECK(figures["cases"][12]["key"] == "all");
  CHECK(figures["cases"][12]["findings"]["runs"] == 12);
  figures["cases"][3]["findings"]["equal"] = false;
  equality.write(figures);
  const Outcome differs = equality.run("--scenes hall --resume");
  CHECK(differs.exit_code == 1);
  CHECK_THAT(differs.out, Contains("12 runs: 1 differ"));
  CHECK(equality.figures()["cases"][12]["findings"]["differing"] == 1);
}

TEST_CASE("equality: a query of the user's is compared too") {
  const Experiment scene("datasets", 1);
  REQUIRE(scene.run("--scenes tunnel").exit_code == 0);
  const auto files = scene.work() / "tunnel-smoke";
  const Experiment equality("equality", 1);
  const std::string query = "--scenes hall --env " + quoted(scene.work() / "tunnel-smoke.h5");
  CHECK(equality.run(query).exit_code == 2);
  const Outcome done = equality.run(query + " --model " + quoted(files / "model.ply") +
                                    " --trajectory " + quoted(files / "trajectory.txt"));
  CAPTURE(done.err);
  CHECK(done.exit_code == 0);
  CHECK_THAT(done.out, Contains("18 runs: 0 differ"));
}

TEST_CASE("hard: the sweep and the k-d tree give the same bytes") {
  const Experiment hard("hard", 1);
  const Outcome done = hard.run();
  CAPTURE(done.err);
  REQUIRE(done.exit_code == 0);
  std::set<std::string> cases;
  const Json figures = hard.figures();
  for (const Json& one : figures["cases"]) {
    CAPTURE(one["key"]);
    cases.insert(one["parameters"]["case"]);
    const bool compared = one["parameters"]["engine"] == "kdtree cpu";
    CHECK(one.contains("findings") == compared);
    if (compared) CHECK(one["findings"]["equal"]);
  }
  CHECK(cases.size() == 13);
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
  if (help.out.find("nanoflann") == std::string::npos) return;  // not found by the build
  const Outcome peers = run_program_at(CLEARWAY_BENCH_PROGRAM, folder, "peers" + query);
  CAPTURE(peers.err);
  REQUIRE(peers.exit_code == 0);
  CHECK(Json::parse(peers.out)["differing_points"] == 0);
}
