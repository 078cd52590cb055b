// The built program clearway-bench: its options, its files, and how it continues an experiment.
#include <fstream>

#include "bench/measure/failure.hpp"
#include "bench/measure/work_folder.hpp"
#include "support/catch.hpp"
#include "tools/bench/experiment.hpp"

using namespace clearway::test;

TEST_CASE("an experiment that was stopped goes on where it was") {
  const Experiment threads("threads");
  require_success(threads.run());
  Json figures = threads.figures();
  const std::size_t cases = figures["cases"].size();
  REQUIRE(cases > 2);
  for (const Json& one : figures["cases"]) CHECK(one["runs"].size() == 2);
  const Json first = figures["cases"][0];
  figures["cases"] = Json::array({first});
  threads.write(figures);
  check_outcome(threads.run(), 2, "--resume");
  require_success(threads.run("--resume"));
  CHECK(threads.figures()["cases"].size() == cases);
  CHECK(threads.figures()["cases"][0] == first);
}

TEST_CASE("figures of another experiment or size, or of something else, are not gone on with") {
  const Experiment threads("threads");
  threads.write({{"experiment", "table"}, {"cases", Json::array()}});
  check_outcome(threads.run("--resume"), 2,
                "differs in experiment: table in the file, threads now");
  for (const std::string odd : {"[1]", R"({"cases": [1]})", R"({"cases": [{}]})"}) {
    threads.write(Json::parse(odd));
    check_outcome(threads.run("--resume"), 3);
  }
  std::ofstream(threads.file()) << "{";
  check_outcome(threads.run("--resume"), 3);
}

TEST_CASE("a run that exceeds the limit has failed, and the experiment goes on") {
  const Experiment table("table");
  require_success(table.run("--scenes hall --limit 1"));
  const std::size_t cases = table.figures()["cases"].size();
  CHECK(cases == 4);
  check_outcome(table.run("--scenes hall --memory abc"), 2);
}

TEST_CASE("what a smaller limit has stopped is measured anew, in its place") {
  const Experiment table("table");
  const std::string options = "--scenes hall --resume --limit ";
  require_success(table.run(options + "20"));
  Json figures = table.figures();
  check_json(figures, R"({"parameters": {"limit": 20}})");
  // The second case is in the present form; the last one and the parameters are in the earlier
  // form.
  figures["parameters"].erase("limit");
  for (const std::size_t i : {1, 2}) figures["cases"][i]["runs"] = Json::array();
  figures["cases"][1]["failed"] = {{"after_seconds", 21.5}, {"limit", 20}};
  figures["cases"][2]["failed"] = {{"after_seconds", 21.5}};
  table.write(figures);
  require_success(table.run(options + "20"));
  CHECK(table.figures()["cases"] == figures["cases"]);
  for (const auto& [limit, anew] : {std::pair{"21", 1}, {"22", 2}}) {
    require_success(table.run(options + limit));
    const Json now = table.figures();
    CHECK(now["parameters"]["limit"] == std::stod(limit));
    REQUIRE(now["cases"].size() == 4);
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
  const Experiment table("table");
  require_success(table.run("--scenes hall"));
  const std::pair<std::string, std::string> differences[] = {
      {"--scenes hall --device-memory 3G", "differs in --device-memory: 2G in the file, 3G now"},
      {"--scenes hall --memory 5G", "differs in --memory: 4G in the file, 5G now"}};
  for (const auto& [options, difference] : differences) {
    check_outcome(table.run(options + " --resume"), 2, difference);
  }
  Json figures = table.figures();
  figures["parameters"].erase("repetitions");
  table.write(figures);
  check_outcome(table.run("--scenes hall --resume"), 2,
                "differs in --repetitions: nothing in the file, 2 now");
}

TEST_CASE("a file is continued with other scenes") {
  const Experiment table("table", 1);
  require_success(table.run("--scenes hall"));
  const Json before = table.figures();
  require_success(table.run("--scenes tunnel,hall --resume"));
  const Json after = table.figures();
  check_json(after, R"({"parameters": {"scenes": ["hall", "tunnel"]}})");
  REQUIRE(after["cases"].size() == 2 * before["cases"].size());
  for (std::size_t i = 0; i < before["cases"].size(); ++i) {
    CHECK(after["cases"][i] == before["cases"][i]);
  }
}

TEST_CASE("scenes are chosen where an experiment is about any") {
  const Experiment scaling("scaling");
  check_outcome(scaling.run("--scenes hall"), 2, "--scenes is for table, share, equality");
  CHECK_FALSE(std::filesystem::exists(scaling.file()));
}

TEST_CASE("a work folder is of one bench at a time") {
  const Experiment table("table");
  {
    const clearway::bench::WorkFolder taken(table.work());
    check_outcome(table.run("--scenes hall"), 4, "another clearway-bench uses it");
    CHECK_FALSE(std::filesystem::exists(table.file()));
  }
  check_outcome(table.run("--scenes hall"), 0);
}

TEST_CASE("a work folder of another program is refused, whatever it holds") {
  const Experiment share("share", 1);  // keeps no answers
  require_success(share.run("--scenes hall"));
  const auto note = share.work() / "made-by.json";
  Json program = Json::parse(bytes_of(note));
  const Json header = share.figures()["clearway"];
  for (const char* name : {"version", "commit", "build"}) CHECK(program[name] == header[name]);
  const bool clean = !clearway::bench::may_have_changed(program);
  const Outcome resumed = share.run("--scenes hall --resume");
  check_outcome(resumed, 0);
  const std::string changed = "but the source may have changed";
  CHECK((resumed.err.find(changed) == std::string::npos) == clean);
  program["commit"] = "0123456789ab";
  std::ofstream(note) << program;
  check_outcome(share.run("--scenes hall --force"), 2,
                "commit 0123456789ab ... " + header["commit"].get<std::string>() +
                    " ... another --work or remove the folder");
  std::filesystem::remove(note);
  check_outcome(share.run("--scenes hall --force"), 0,
                "scenes and stores of an unknown program are used");
}

TEST_CASE("a failure that says nothing of the method ends the experiment") {
  const Experiment scaling("scaling");
  std::filesystem::create_directories(scaling.work() / "result.h5");
  check_outcome(scaling.run(), 4, "kdtree cpu/poses/100 ... is a directory");
  CHECK(scaling.figures()["cases"].empty());
}

TEST_CASE("another clearway is measured where it is named") {
  const Experiment table("table", 1);
  check_outcome(table.run("--scenes hall --program /dev/null"), 2, "--program");
  check_outcome(table.run("--scenes hall --cold --program '" CLEARWAY_PROGRAM "'"), 0);
  const Json program = table.figures()["clearway"];
  CHECK(program["build"] == CLEARWAY_PROGRAM);
  check_json(program, R"({"commit": "unknown"})");
  CHECK(table.figures()["parameters"]["cold"] == true);
}

TEST_CASE("stages print one JSON object") {
  const Experiment scene("table", 1);
  require_success(scene.run("--scenes hall"));
  const auto files = scene.work() / "hall-smoke";
  const ScratchFolder folder;
  const std::string query = " --env " + quoted(scene.work() / "hall-smoke.h5") + " --model " +
                            quoted(files / "model.ply") + " --trajectory " +
                            quoted(files / "trajectory.txt");
  const Outcome stages =
      require_success(run_program_at(CLEARWAY_BENCH_PROGRAM, folder, "stages --cold" + query));
  CHECK(Json::parse(stages.out)["cells_read"] == 1);
}

TEST_CASE("the refusals that an experiment expects are told from what clearway prints") {
  using namespace clearway::bench;
  const Experiment scene("table", 1);
  require_success(scene.run("--scenes hall"));
  const auto files = scene.work() / "hall-smoke";
  const ScratchFolder folder;
  std::ofstream(folder / "stretched.txt") << "1.1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n";
  const auto refused = [&](const std::filesystem::path& trajectory, const std::string& options) {
    const Outcome outcome = run_program_at(
        CLEARWAY_PROGRAM, folder,
        "run --radius 0.1 -o r.h5 --env " + quoted(scene.work() / "hall-smoke.h5") + " --model " +
            quoted(files / "model.ply") + " --trajectory " + quoted(trajectory) + " " + options);
    ProgramRun run;
    run.exit_code = outcome.exit_code;
    run.log = outcome.err;
    return run;
  };
  const ProgramRun memory = refused(files / "trajectory.txt", "--memory 1");
  CHECK(is_finding(memory, Refusal::kMemory));
  CHECK(amount_in(memory.log, clearway::Remedy::kMoreMemory) > 1'000'000U);
  const ProgramRun stretched = refused(folder / "stretched.txt", "");
  CHECK(is_finding(stretched, Refusal::kNonRigidPoses));
  CHECK_FALSE(is_finding(stretched, Refusal::kMemory));
}
