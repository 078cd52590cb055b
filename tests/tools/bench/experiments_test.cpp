// What the experiments of the built program clearway-bench find, on scenes of a few thousand
// points.
#include <map>
#include <set>

#include "support/catch.hpp"
#include "tools/bench/experiment.hpp"

using namespace clearway::test;

TEST_CASE("table: every exact engine finds the same points") {
  const Experiment table("table", 1);
  require_success(table.run());
  const Json figures = table.figures();
  check_json(figures, R"({"experiment": "table"})");
  CHECK(figures["machine"]["cores"] > 0);
  CHECK_FALSE(figures["clearway"]["commit"].get<std::string>().empty());
  std::set<std::string> scenes;
  for (const Json& one : figures["cases"]) {
    CAPTURE(one["key"]);
    scenes.insert(one["parameters"]["scene"]);
    CHECK(one["runs"].size() == 1);
    check_json(one, R"({"runs": {"0": {"environment_points": 20000}}})");
    CHECK(one["runs"][0]["wall_seconds"] > 0);
    if (one["parameters"]["exact"]) CHECK(one["findings"]["equal"]);
  }
  CHECK(scenes.size() == 4);
}

TEST_CASE("share: whatever a search is made to touch, it finds the same points") {
  const Experiment share("share", 1);
  require_success(share.run("--scenes hall"));
  std::map<std::string, Json> found;
  const Json figures = share.figures();
  for (const Json& one : figures["cases"]) {
    if (one.contains("findings")) found[one["parameters"]["way"]] = one["findings"];
  }
  const Json& as_it_is = found.at("as it is");
  CHECK(as_it_is["colliding_points"] > 0);
  CHECK(as_it_is["points_tested"] < as_it_is["points"]);
  CHECK(as_it_is["bricks_made"] <= as_it_is["bricks"]);
  for (const std::string way : {"all cells", "whole field"}) {
    CAPTURE(way);
    CHECK(found.at(way)["colliding_points"] == as_it_is["colliding_points"]);
  }
  CHECK(found["all cells"]["cells_read"] == as_it_is["cells"]);
  CHECK(found["whole field"]["bricks_made"] == as_it_is["bricks"]);
  CHECK(found["poses one by one"]["seconds"] > 0);
}

TEST_CASE("grid: its regular layouts say how many points a chunk has") {
  const Experiment grid("grid", 1);
  require_success(grid.run());
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
  require_success(surfaces.run());
  std::set<std::string> spacings;
  const Json figures = surfaces.figures();
  for (const Json& one : figures["cases"]) {
    CAPTURE(one["key"]);
    check_json(one, R"({"findings": {"false_hits": 0}})");
    spacings.insert(one["parameters"]["value"]);
    if (one["parameters"]["method"] == "surface") CHECK(one["findings"]["misses"] == 0);
  }
  CHECK(spacings == std::set<std::string>{"", "r / 12", "r / 16", "r / 4", "r / 8"});
}

TEST_CASE("seen: what is swept grows with the path, and more beams see more of it") {
  const Experiment seen("seen", 1);
  require_success(seen.run("--scenes hall"));
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
  CHECK(swept["cube"][0] < swept["cube"][3]);
}

TEST_CASE("section: a section for every outline, whatever bins, cells, load and threads") {
  const Experiment section("section", 1);
  require_success(section.run("--scenes hall"));
  std::map<std::string, std::vector<std::uint64_t>> blocked;
  const Json figures = section.figures();
  for (const Json& one : figures["cases"]) {
    CAPTURE(one["key"]);
    const std::string vary = one["parameters"]["vary"];
    if (one["parameters"]["value"] == "brute force") {
      CHECK(one["findings"]["pairs"] > 0);
      CHECK(one["findings"]["seconds"] > 0);
    } else if (vary == "width") {
      check_json(one, R"({"runs": {"0": {"model_solids": 1}}})");
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
  const Outcome done = require_success(accuracy.run("--limit 4"));
  std::set<std::string> methods;
  Json figures = accuracy.figures();
  for (const Json& one : figures["cases"]) {
    CAPTURE(one["key"]);
    const std::string method = one["parameters"]["method"];
    methods.insert(method);
    if (one.contains("failed")) {
      check_json(one, R"({"failed": {"limit": 4}})");
      const std::string key = one["key"];
      check_says(done.err, "warning: " + key + ": counted as failed: stopped after");
      continue;
    }
    const Json& wrong = one["findings"];
    if (method == "exact") CHECK(wrong["false_hits"].get<int>() + wrong["misses"].get<int>() == 0);
    if (method == "tolerance") {
      const double tolerance = std::stod(one["parameters"]["value"].get<std::string>());
      CHECK(wrong["largest_distance"].get<double>() <= tolerance);
      check_json(wrong, R"({"beyond": 0})");
    }
  }
  CHECK(methods.size() == 8);
  check_json(figures, R"({"cases": {"1": {"key": "exact/sweep cpu/\"\""}}})");
  figures["cases"][1]["findings"]["misses"] = 1;
  accuracy.write(figures);
  const Outcome wrong = accuracy.run("--limit 4 --resume");
  CHECK(wrong.exit_code != 0);
  check_says(wrong.err, "engines that decide exactly are wrong: exact/sweep cpu/");
}

TEST_CASE("equality: counts and writes what differs from the sweep on the CPU") {
  const Experiment equality("equality", 1);
  check_says(require_success(equality.run("--scenes hall")).out,
             "4 runs: 0 differ ... 0 took more");
  Json figures = equality.figures();
  CHECK(figures["cases"].size() == 5);
  check_json(figures, R"({"cases": {"4": {"key": "all", "findings": {"runs": 4}}}})");
  figures["cases"][3]["findings"]["equal"] = false;
  equality.write(figures);
  check_outcome(equality.run("--scenes hall --resume"), 1, kAnything, "4 runs: 1 differ");
  CHECK(equality.figures()["cases"][4]["findings"]["differing"] == 1);
}

TEST_CASE("equality: a query of the user's is compared too") {
  const Experiment scene("table", 1);
  require_success(scene.run("--scenes tunnel"));
  const auto files = scene.work() / "tunnel-smoke";
  const Experiment equality("equality", 1);
  const std::string query = "--scenes hall --env " + quoted(scene.work() / "tunnel-smoke.h5");
  check_outcome(equality.run(query), 2);
  check_outcome(equality.run(query + " --model " + quoted(files / "model.ply") + " --trajectory " +
                             quoted(files / "trajectory.txt")),
                0, kAnything, "6 runs: 0 differ");
}

TEST_CASE("hard: the sweep and the k-d tree give the same bytes") {
  const Experiment hard("hard", 1);
  require_success(hard.run());
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
