#include <nlohmann/json.hpp>

#include "support/catch.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// Results a.h5 and b.h5 about one environment. b lacks a's second point, has another first pose
/// for its third, and another radius.
struct Pair : Workplace {
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
};

}  // namespace

TEST_CASE("compare of equal results exits with 0") {
  const Pair pair;
  const Outcome outcome = pair.run("compare a.h5 a.h5");
  check_outcome(outcome, 0, kAnything, "in both: 4\n ... \nequal\n");
  CHECK(outcome.err.empty());
}

TEST_CASE("compare of different results says how and exits with 1") {
  const Pair pair;
  const Outcome outcome = pair.run("compare a.h5 b.h5");
  check_outcome(outcome, 1, kAnything, "a: 4 colliding points ... b: 3 colliding points");
  check_says(outcome.out, "only in a: 1\n ... only in b: 0\n");
  check_says(outcome.out, "differing first poses: 1\n");
  check_says(outcome.out, "queries differ: radius: 0.1 m / 0.2 m\n");
  check_says(outcome.out, "  only in a  4   ...   first pose  8  ");
  check_says(outcome.out, "/ 77\n ... different\n");
}

TEST_CASE("compare says how depths differ") {
  const Workplace place;
  ResultHeader header = sample_header(false);
  Collisions rows = sample_rows(header, 3);
  write_result(place.folder / "plain.h5", header, rows);
  add_sample_depths(header, rows);
  write_result(place.folder / "a.h5", header, rows);
  rows.depth[1] = 9.5;
  rows.depth_source[1] = 7;
  rows.depth[2] = 0.75;
  rows.depth_source[2] = 8;
  write_result(place.folder / "b.h5", header, rows);
  check_outcome(place.run("compare a.h5 a.h5"), 0, kAnything, "differing depths: 0\n");
  const Outcome outcome = place.run("compare a.h5 b.h5");
  check_outcome(outcome, 1, kAnything, "differing depths: 2\n");
  check_says(outcome.out, "depth ... / 9.5 to 7\n");
  check_says(outcome.out, "depth ... nothing free / 0.75 to 8\n");
  check_json(json_of(place.run("compare --json a.h5 b.h5")),
             R"({"equal": false, "differing_depths": 2,
    "differences": {"0": {"kind": "depth", "depth_b": 9.5, "depth_source_b": 7},
                    "1": {"depth_a": null, "depth_source_a": null, "depth_b": 0.75}}})");
  const Outcome plain = place.run("compare a.h5 plain.h5");
  check_lacks(plain.out, "differing depths");
  for (const char* ending : {"las", "ply", "csv", "xyz"}) {
    check_outcome(place.run(std::string("export a.h5 -o out.") + ending), 0);
  }
}

TEST_CASE("compare shows as many points as asked for") {
  const Pair pair;
  const Outcome outcome = pair.run("compare --show 1 a.h5 b.h5");
  check_says(outcome.out, "first 1 of 2 differences");
  check_lacks(outcome.out, "  first pose  ");
}

TEST_CASE("compare --json is one JSON object") {
  const Pair pair;
  const Outcome outcome = pair.run("compare --json a.h5 b.h5");
  check_outcome(outcome, 1);
  const auto facts = json_of(outcome);
  check_json(facts, R"({
    "equal": false, "a": {"colliding_points": 4}, "b": {"colliding_points": 3}, "common": 3,
    "only_in_a": 1, "only_in_b": 0, "differing_first_poses": 1,
    "question_differences": {"0": {"what": "radius"}}})");
  CHECK(facts["question_differences"].size() == 1);
  REQUIRE(facts["differences"].size() == 2);
  const Collisions rows = sample_rows(sample_header(true), 4);
  check_json(facts, R"({"differences": {"0": {"kind": "only in a"}, "1": {"first_pose_b": 77}}})");
  CHECK(facts["differences"][0]["source"] == rows.source[1]);
  CHECK(facts["differences"][0]["xyz"][2].get<double>() == rows.xyz[1].z);
  CHECK(facts["differences"][1]["first_pose_a"] == rows.first_pose[2]);
}

TEST_CASE("compare refuses what cannot be compared") {
  const Pair pair;
  const Outcome elsewhere = pair.run("compare a.h5 elsewhere.h5");
  check_outcome(elsewhere, 3, "different environments");
  CHECK(elsewhere.out.empty());
  check_outcome(pair.run("compare a.h5 missing.h5"), 4);
  check_outcome(pair.run("compare a.h5"), 2);
}

TEST_CASE("export writes what the ending says") {
  const Pair pair;
  const std::string ending = GENERATE("las", "ply", "xyz", "csv");
  const std::string arguments = "export a.h5 -o colliding." + ending;
  check_refused(pair.run(arguments), 0, "4 colliding points");
  CHECK_FALSE(bytes_of(pair.folder / ("colliding." + ending)).empty());

  check_outcome(pair.run(arguments), 2, "--force");
  check_outcome(pair.run(arguments + " --force"), 0);
}

TEST_CASE("export says what is wrong with its arguments") {
  const Pair pair;
  pair.check({
      {"export a.h5 -o a.laz", 2, ".las, .ply, .xyz or .csv"},
      {"export a.h5", 2},
      {"export no.h5 -o a.csv", 4},
      {"export a.h5 -o no/a.csv", 4},
  });
}

TEST_CASE("a full disk ends both commands with 4") {
  const Pair pair;
  const auto exit_code = [&](const std::string& command) {
    return WEXITSTATUS(std::system(("cd " + pair.path("") + " && " + command).c_str()));
  };
  const std::string program = "'" CLEARWAY_PROGRAM "' ";
  check_equal(exit_code(program + "compare a.h5 b.h5 >/dev/full 2>/dev/null"), 4);
  check_equal(
      exit_code("trap '' XFSZ; ulimit -f 0; " + program + "export a.h5 -o a.csv 2>/dev/null"), 4);
  CHECK_FALSE(pair.has("a.csv"));
  CHECK_FALSE(pair.has("a.csv.partial"));
}

TEST_CASE("both commands explain themselves") {
  const Pair pair;
  pair.check({
      {"compare --help-all", 0, "", "--show ... --json ... Exit code 0 ... Example:"},
      {"export --help-all", 0, "", "metres ... .las ... .ply ... .xyz ... .csv ... Example:"},
  });
}
