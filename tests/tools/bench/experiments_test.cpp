// What the experiments of the built program clearway-bench find, on scenes of a few thousand
// points.
#include <catch2/catch.hpp>
#include <map>
#include <set>

#include "tools/bench/experiment.hpp"

using namespace clearway::test;
using Catch::Contains;

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

TEST_CASE("surfaces: points on a surface miss what is beyond their spacing alone") {
  const Experiment surfaces("surfaces", 1);
  const Outcome done = surfaces.run();
  CAPTURE(done.err);
  REQUIRE(done.exit_code == 0);
  std::set<std::string> spacings;
  const Json figures = surfaces.figures();
  for (const Json& one : figures["cases"]) {
    CAPTURE(one["key"]);
    CHECK(one["findings"]["false_hits"] == 0);
    spacings.insert(one["parameters"]["value"]);
    if (one["parameters"]["method"] == "surface") CHECK(one["findings"]["misses"] == 0);
  }
  CHECK(spacings == std::set<std::string>{"", "r / 12", "r / 16", "r / 4", "r / 8"});
}

TEST_CASE("seen: what is swept grows with the path, and more beams see more of it") {
  const Experiment seen("seen", 1);
  const Outcome done = seen.run("--scenes hall");
  CAPTURE(done.err);
  REQUIRE(done.exit_code == 0);
  std::set<std::string> varied;
  std::map<std::string, std::vector<std::uint64_t>> swept, unseen;
  const Json figures = seen.figures();
  for (const Json& one : figures["cases"]) {
    CAPTURE(one["key"]);
    const std::string vary = one["parameters"]["vary"];
    varied.insert(vary);
    REQUIRE(one["runs"].size() == 1);
    const Json& run = one["runs"][0];
    const bool asked = !run["seen"].is_null();
    CHECK((run["seconds"]["beams"] > 0) == asked);
    if (!asked) continue;
    CHECK(run["seconds"]["swept"] > 0);
    swept[vary].push_back(run["seen"]["swept"]);
    unseen[vary].push_back(run["seen"]["unseen"]);
  }
  CHECK(varied == std::set<std::string>{"beams", "cube", "path", "question", "threads"});
  CHECK(swept["beams"] == std::vector(4, swept["beams"][0]));
  CHECK(swept["path"].size() == 4);
  CHECK(std::is_sorted(swept["path"].begin(), swept["path"].end()));
  CHECK(swept["path"][0] < swept["path"][3]);
  CHECK(unseen["beams"][3] < unseen["beams"][0]);
  CHECK(swept["cube"][0] < swept["cube"][4]);
}

TEST_CASE("section: a section for every outline, whatever bins, cells, load and threads") {
  const Experiment section("section", 1);
  const Outcome done = section.run("--scenes hall");
  CAPTURE(done.err);
  REQUIRE(done.exit_code == 0);
  std::map<std::string, std::vector<std::uint64_t>> blocked;
  const Json figures = section.figures();
  for (const Json& one : figures["cases"]) {
    CAPTURE(one["key"]);
    const std::string vary = one["parameters"]["vary"];
    if (one["parameters"]["value"] == "brute force") {
      CHECK(one["findings"]["pairs"] > 0);
      CHECK(one["findings"]["seconds"] > 0);
    } else if (vary == "width") {
      CHECK(one["runs"][0]["model_solids"] == 1);
    } else {
      blocked[vary].push_back(one["runs"][0]["blocked"]);
    }
  }
  CHECK(blocked["bin"] == std::vector(4, blocked["bin"][0]));
  CHECK(std::set(blocked["threads"].begin(), blocked["threads"].end()).size() == 1);
  CHECK(blocked["cell"][0] < blocked["cell"][3]);
  CHECK(blocked["length"][0] < blocked["length"][3]);
  CHECK(blocked["method"].front() == blocked["bin"][2]);
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
  CHECK_THAT(done.out, Contains("16 runs: 0 differ") && Contains("0 took more"));
  Json figures = equality.figures();
  CHECK(figures["cases"].size() == 17);
  CHECK(figures["cases"][16]["key"] == "all");
  CHECK(figures["cases"][16]["findings"]["runs"] == 16);
  figures["cases"][3]["findings"]["equal"] = false;
  equality.write(figures);
  const Outcome differs = equality.run("--scenes hall --resume");
  CHECK(differs.exit_code == 1);
  CHECK_THAT(differs.out, Contains("16 runs: 1 differ"));
  CHECK(equality.figures()["cases"][16]["findings"]["differing"] == 1);
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
  CHECK_THAT(done.out, Contains("22 runs: 0 differ"));
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
