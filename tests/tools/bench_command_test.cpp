// The built program's `bench`, on scenes of a few thousand points.
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "program.hpp"

using namespace clearway::test;
using Catch::Contains;
using Json = nlohmann::ordered_json;

namespace {

class Experiment {
 public:
  explicit Experiment(const std::string& name) : name_(name) {}

  Outcome run(const std::string& more = "") const {
    return run_program(folder_,
                       "bench " + name_ + " --size smoke --device cpu --repetitions 2 -o " +
                           quoted(file()) + " --work " + quoted(folder_ / "work") + " " + more);
  }
  std::filesystem::path file() const { return folder_ / "figures.json"; }
  Json figures() const { return Json::parse(bytes_of(file())); }
  void write(const Json& figures) const { std::ofstream(file()) << figures.dump(); }

 private:
  std::string name_;
  ScratchFolder folder_;
};

}  // namespace

TEST_CASE("bench table: every exact engine finds the same points") {
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
  CHECK_THAT(another.err, Contains("its experiment is another"));
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

TEST_CASE("bench accuracy: exact engines err nowhere, the others say where") {
  const Experiment accuracy("accuracy");
  const Outcome done = accuracy.run("--limit 4");
  CAPTURE(done.err);
  REQUIRE(done.exit_code == 0);
  std::set<std::string> methods;
  const Json figures = accuracy.figures();
  for (const Json& one : figures["cases"]) {
    CAPTURE(one["key"]);
    const std::string method = one["parameters"]["method"];
    methods.insert(method);
    if (one.contains("failed")) continue;
    const Json& wrong = one["findings"];
    if (method == "exact") CHECK(wrong["false_hits"].get<int>() + wrong["misses"].get<int>() == 0);
    if (method == "tolerance") {
      const double tolerance = std::stod(one["parameters"]["value"].get<std::string>());
      CHECK(wrong["largest_distance"].get<double>() <= tolerance);
      CHECK(wrong["beyond"] == 0);
    }
  }
  CHECK(methods.size() == 8);
}
