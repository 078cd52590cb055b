// Vehicles as a user runs them: devices, shards, ignored points, and warnings.
#include <nlohmann/json.hpp>
#include <set>

#include "clearway/result.hpp"
#include "support/catch.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;

namespace {

/// Ground, a wall on either side of a path along x, and a post beside it. Two bodies in a row.
struct Yard : Workplace {
  Yard() {
    std::string scan;
    for (int i = 0; i < 300; ++i) {
      for (int k = -15; k <= 15; ++k) scan += at(i, k, 0);
      for (int k = 0; k < 10; ++k) scan += at(i, -15, k) + at(i, 15, k);
    }
    for (int k = 0; k < 10; ++k) scan += at(150, 6, k);
    put("scan.xyz", scan);
    std::string box;
    for (int i = -5; i <= 5; ++i) {
      for (int k = -5; k <= 5; ++k) {
        for (const std::string z : {"0.3", "1.1"}) {
          box += std::to_string(i * 0.1) + " " + std::to_string(k * 0.1) + " " + z + "\n";
        }
      }
    }
    put("box.xyz", box);
    put("path.txt", path_along_x(181, 0.1, 2));
    put("far.txt", path_along_x(181, 0.1, 1000));
    put_vehicle(R"({"name": "truck", "model": "box.xyz"})");
    require_success(run("convert scan.xyz -o site.h5 --cell-points 512"));
  }

  static std::string at(int i, int k, int j) {
    return std::to_string(i * 0.1) + " " + std::to_string(k * 0.1) + " " + std::to_string(j * 0.2) +
           "\n";
  }
  void put_vehicle(const std::string& truck) const {
    put("wagon.json", "{\"bodies\": [" + truck +
                          R"(, {"name": "trailer", "model": "box.xyz", "pivots": [-1, -2]}]})");
  }
  Outcome search(const std::string& arguments) const {
    return run("run --env site.h5 --vehicle wagon.json --trajectory path.txt --threads 2 --force " +
               arguments);
  }
};

}  // namespace

TEST_CASE("a vehicle is searched on a GPU too, to the same bytes") {
  const Yard yard;
  const std::string query = "--radius 0.2 --first-pose --clearance 0.5 --profile 0.5 ";
  require_success(yard.search(query + "-o cpu.h5 --device cpu"));
  const Outcome cuda = yard.search(query + "-o cuda.h5 --device cuda --json");
  if (cuda.exit_code == 0) {
    check_json(json_of(cuda), R"({"device": "cuda"})");
    check_same(yard.bytes("cuda.h5"), yard.bytes("cpu.h5"));
  } else {
    check_says(cuda.err, "CUDA");
  }
  check_says(yard.search("--radius 0.2 -o out.h5 --engine grid").err, "--vehicle: engine");
}

TEST_CASE("shards of a vehicle merge to the bytes of its whole run") {
  const Yard yard;
  const std::string query = "--radius 0.2 --first-pose --clearance 0.5 --profile 0.5 ";
  require_success(yard.search(query + "-o whole.h5"));
  std::string parts;
  for (const std::string part : {"1", "2", "3"}) {
    require_success(yard.search(query + "--shard " + part + "/3 -o part" + part + ".h5"));
    parts += " part" + part + ".h5";
  }
  const Outcome merged = yard.succeed("merge" + parts + " -o merged.h5");
  check_says(merged.out, "body truck");
  check_same(yard.bytes("merged.h5"), yard.bytes("whole.h5"));
  yard.put_vehicle(R"({"name": "lorry", "model": "box.xyz"})");
  require_success(yard.search(query + "--shard 2/3 -o part2.h5"));
  check_outcome(yard.run("merge" + parts + " -o merged.h5 --force"), 3, "part2.h5");
}

TEST_CASE("a vehicle may touch what the search ignores") {
  const Yard yard;
  require_success(yard.search("--radius 0.2 --first-pose -o out.h5"));
  CHECK(Result(yard.folder / "out.h5").size() > 0);
  require_success(
      yard.search("--radius 0.2 --first-pose -o out.h5 --ignore-box 14,0.5,-1,16,0.7,3"));
  const Result result(yard.folder / "out.h5");
  CHECK(result.size() == 0);
  CHECK(result.ignored().points > 9);
  const json info = json_of(yard.run("info out.h5 --json"));
  check_json(info, R"({"version": 6, "bodies": ["truck", "trailer"]})");
  CHECK(info["ignored"]["points"] == result.ignored().points);
  check_outcome(yard.run("verify out.h5"), 0);
}

TEST_CASE("a body that is far from the scan is warned of by name") {
  const Yard yard;
  yard.put_vehicle(R"({"name": "truck", "model": "box.xyz", "trajectory": "far.txt"})");
  const Outcome found = yard.search("--radius 0.05 -o out.h5 --json");
  const json report = json_of(found);
  bool told = false;
  for (const json& warning : report["warnings"]) {
    if (warning["code"] != "out-of-reach") continue;
    told = warning["message"].get<std::string>().find("body truck: ") == 0;
  }
  INFO(found.err);
  CHECK(told);
  check_outcome(yard.search("--radius 0.05 -o out.h5 --strict"), 3);
}

TEST_CASE("a vehicle above the ground is warned of and one on it is not") {
  const Yard yard;
  const auto codes = [](const Outcome& outcome) {
    std::set<std::string> out;
    const json report = json_of(outcome);
    for (const json& warning : report["warnings"]) out.insert(warning["code"]);
    return out;
  };
  CHECK(codes(yard.search("--radius 0.2 -o out.h5 --json")).count("floats") == 0);
  std::string high;
  for (int i = 0; i <= 180; ++i) {
    high += "1 0 0 " + std::to_string(2 + i * 0.1) + " 0 1 0 0 0 0 1 9\n";
  }
  // Only the trailer is on the ground; the truck is like a load on a crane.
  yard.put("high.txt", high);
  yard.put_vehicle(R"({"name": "truck", "model": "box.xyz", "trajectory": "high.txt"})");
  CHECK(codes(yard.search("--radius 0.2 -o out.h5 --json")).count("floats") == 0);
  yard.put("path.txt", high);
  yard.put_vehicle(R"({"name": "truck", "model": "box.xyz"})");
  CHECK(codes(yard.search("--radius 0.2 -o out.h5 --json")).count("floats") == 1);
}

TEST_CASE("poses that the path misses are warned of once, for the vehicle and all its shards") {
  const Yard yard;
  std::string path;
  for (int i = 0; i <= 180; ++i) {
    if (i < 60 || i >= 120) path += pose_at(2 + i * 0.1);
  }
  yard.put("path.txt", path);
  const auto jumps = [](const Outcome& outcome) {
    std::vector<std::string> texts;
    const json all = json_of(outcome);
    for (const json& warning : all["warnings"]) {
      if (warning["code"] == "trajectory-jump") texts.push_back(warning["message"]);
    }
    return texts;
  };
  const Outcome whole = require_success(yard.search("--radius 0.3 -o whole.h5 --json"));
  REQUIRE(jumps(whole).size() == 1);
  check_says(jumps(whole)[0], "the path: the step from pose 59 to 60 is 6.1 m");
  CHECK(whole.err.find("the model moves farther") == std::string::npos);
  for (const std::string part : {"1", "2"}) {
    const Outcome shard =
        yard.search("--radius 0.3 --json --shard " + part + "/2 -o " + part + ".h5");
    CHECK(jumps(shard) == jumps(whole));
  }
  CHECK(jumps(yard.run("merge 1.h5 2.h5 -o merged.h5 --json")) == jumps(whole));
}

TEST_CASE("poses that a body's own trajectory misses are its own") {
  const Yard yard;
  std::string own;
  for (int i = 0; i <= 180; ++i) {
    own += pose_at(2 + i * 0.1 + (i > 90 ? 5 : 0));
  }
  yard.put("own.txt", own);
  yard.put_vehicle(R"({"name": "truck", "model": "box.xyz", "trajectory": "own.txt"})");
  const Outcome outcome = yard.search("--radius 0.3 -o out.h5");
  check_says(outcome.err, "body truck: the step from pose 90 to 91 is 5.1 m");
  CHECK(outcome.err.find("the path: the step") == std::string::npos);
}
