#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

namespace {

/// Results a.h5 and b.h5 about one environment. b lacks a's second point, has another first pose
/// for its third, and another radius.
struct Pair {
  Pair() {
    ResultHeader header = sample_header(true);
    Collisions rows = sample_rows(header, 4);
    write_result(folder / "a.h5", header, rows);
    rows.source.erase(rows.source.begin() + 1);
    rows.xyz.erase(rows.xyz.begin() + 1);
    rows.first_pose.erase(rows.first_pose.begin() + 1);
    rows.first_pose[1] = 77;
    rows.last_pose.erase(rows.last_pose.begin() + 1);
    header.radius = 0.2;
    write_result(folder / "b.h5", header, rows);
    header.environment_hash = 1;
    write_result(folder / "elsewhere.h5", header, rows);
  }

  Outcome run(const std::string& arguments) const { return run_program(folder, arguments); }
  std::string path(const std::string& name) const { return quoted(folder / name); }

  ScratchFolder folder;
};

}  // namespace

TEST_CASE("compare of equal results exits with 0") {
  const Pair pair;
  const Outcome outcome = pair.run("compare " + pair.path("a.h5") + " " + pair.path("a.h5"));
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.out, Contains("in both: 4\n") && Contains("\nequal\n"));
  CHECK(outcome.err.empty());
}

TEST_CASE("compare of different results says how and exits with 1") {
  const Pair pair;
  const Outcome outcome = pair.run("compare " + pair.path("a.h5") + " " + pair.path("b.h5"));
  CHECK(outcome.exit_code == 1);
  CHECK_THAT(outcome.out, Contains("a: 4 colliding points") && Contains("b: 3 colliding points"));
  CHECK_THAT(outcome.out, Contains("only in a: 1\n") && Contains("only in b: 0\n"));
  CHECK_THAT(outcome.out, Contains("differing first poses: 1\n"));
  CHECK_THAT(outcome.out, Contains("queries differ: radius: 0.1 m / 0.2 m\n"));
  CHECK_THAT(outcome.out, Contains("  only in a  4  ") && Contains("  first pose  8  "));
  CHECK_THAT(outcome.out, Contains("/ 77\n") && Contains("\ndifferent\n"));
}

TEST_CASE("compare shows as many points as asked for") {
  const Pair pair;
  const Outcome outcome =
      pair.run("compare --show 1 " + pair.path("a.h5") + " " + pair.path("b.h5"));
  CHECK_THAT(outcome.out, Contains("first 1 of 2 differences"));
  CHECK_THAT(outcome.out, !Contains("  first pose  "));
}

TEST_CASE("compare --json is one JSON object") {
  const Pair pair;
  const Outcome outcome = pair.run("compare --json " + pair.path("a.h5") + " " + pair.path("b.h5"));
  CHECK(outcome.exit_code == 1);
  const auto json = nlohmann::json::parse(outcome.out);
  CHECK(json["equal"] == false);
  CHECK(json["a"]["colliding_points"] == 4);
  CHECK(json["b"]["colliding_points"] == 3);
  CHECK(json["common"] == 3);
  CHECK(json["only_in_a"] == 1);
  CHECK(json["only_in_b"] == 0);
  CHECK(json["differing_first_poses"] == 1);
  CHECK(json["question_differences"].size() == 1);
  CHECK(json["question_differences"][0]["what"] == "radius");
  REQUIRE(json["differences"].size() == 2);
  const Collisions rows = sample_rows(sample_header(true), 4);
  CHECK(json["differences"][0]["kind"] == "only in a");
  CHECK(json["differences"][0]["source"] == rows.source[1]);
  CHECK(json["differences"][0]["xyz"][2].get<double>() == rows.xyz[1].z);
  CHECK(json["differences"][1]["first_pose_a"] == rows.first_pose[2]);
  CHECK(json["differences"][1]["first_pose_b"] == 77);
}

TEST_CASE("compare refuses what cannot be compared") {
  const Pair pair;
  const Outcome elsewhere =
      pair.run("compare " + pair.path("a.h5") + " " + pair.path("elsewhere.h5"));
  CHECK(elsewhere.exit_code == 3);
  CHECK_THAT(elsewhere.err, Contains("different environments"));
  CHECK(elsewhere.out.empty());
  CHECK(pair.run("compare " + pair.path("a.h5") + " " + pair.path("missing.h5")).exit_code == 4);
  CHECK(pair.run("compare " + pair.path("a.h5")).exit_code == 2);
}

TEST_CASE("export writes what the ending says") {
  const Pair pair;
  const std::string ending = GENERATE("las", "ply", "xyz", "csv");
  const std::string arguments =
      "export " + pair.path("a.h5") + " -o " + pair.path("colliding." + ending);
  const Outcome outcome = pair.run(arguments);
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.out.empty());
  CHECK_THAT(outcome.err, Contains("4 colliding points"));
  CHECK_FALSE(bytes_of(pair.folder / ("colliding." + ending)).empty());

  const Outcome again = pair.run(arguments);
  CHECK(again.exit_code == 2);
  CHECK_THAT(again.err, Contains("--force"));
  CHECK(pair.run(arguments + " --force").exit_code == 0);
}

TEST_CASE("export says what is wrong with its arguments") {
  const Pair pair;
  const Outcome ending = pair.run("export " + pair.path("a.h5") + " -o " + pair.path("a.laz"));
  CHECK(ending.exit_code == 2);
  CHECK_THAT(ending.err, Contains(".las, .ply, .xyz or .csv"));
  CHECK(pair.run("export " + pair.path("a.h5")).exit_code == 2);
  CHECK(pair.run("export " + pair.path("no.h5") + " -o " + pair.path("a.csv")).exit_code == 4);
  CHECK(pair.run("export " + pair.path("a.h5") + " -o " + pair.path("no/a.csv")).exit_code == 4);
}

TEST_CASE("a full disk ends both commands with 4") {
  const Pair pair;
  const auto exit_code = [](const std::string& command) {
    return WEXITSTATUS(std::system(command.c_str()));
  };
  const std::string program = "'" CLEARWAY_PROGRAM "' ";
  CHECK(exit_code(program + "compare " + pair.path("a.h5") + " " + pair.path("b.h5") +
                  " >/dev/full 2>/dev/null") == 4);
  CHECK(exit_code("trap '' XFSZ; ulimit -f 0; " + program + "export " + pair.path("a.h5") + " -o " +
                  pair.path("a.csv") + " 2>/dev/null") == 4);
  CHECK_FALSE(std::filesystem::exists(pair.folder / "a.csv"));
  CHECK_FALSE(std::filesystem::exists(pair.folder / "a.csv.partial"));
}

TEST_CASE("both commands explain themselves") {
  const Pair pair;
  const Outcome compare = pair.run("compare --help"), exporting = pair.run("export --help");
  CHECK(compare.exit_code == 0);
  CHECK_THAT(compare.out, Contains("Exit code 0") && Contains("--json") && Contains("--show") &&
                              Contains("Example:"));
  CHECK(exporting.exit_code == 0);
  CHECK_THAT(exporting.out, Contains(".las") && Contains(".ply") && Contains(".xyz") &&
                                Contains(".csv") && Contains("metres") && Contains("Example:"));
}
