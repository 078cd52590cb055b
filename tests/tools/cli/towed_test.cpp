// Towed bodies as a user runs them: in a run, in shards, and in all that comes after.
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "clearway/result.hpp"
#include "clearway/trajectory.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;
using nlohmann::json;

namespace {

constexpr double kRadius = 15;

std::string line_of(double heading, double x, double y) {
  const std::string c = std::to_string(std::cos(heading)), s = std::to_string(std::sin(heading));
  return c + " -" + s + " 0 " + std::to_string(x) + " " + s + " " + c + " 0 " + std::to_string(y) +
         " 0 0 1 0 0 0 0 1\n";
}

/// A turn of 90 degrees to the left between two lines of 25 m, and posts at its inner side, which a
/// vehicle of 2.5 m passes with 1.2 m to spare as long as it stays on the path.
struct Turn {
  Turn() {
    std::string scan, path, tractor, trailer;
    const double turn = kRadius * std::numbers::pi / 2;
    for (double s = 0; s < 50 + turn; s += 0.1) {
      const double angle = std::min(std::max(s - 25, 0.0), turn) / kRadius;
      path += line_of(angle, std::min(s, 25.0) + kRadius * std::sin(angle),
                      kRadius - kRadius * std::cos(angle) + std::max(s - 25 - turn, 0.0));
    }
    for (int i = 0; i <= 90; i += 2) {
      const double angle = i * std::numbers::pi / 180, radius = kRadius - 1.25 - 1.2;
      for (int z = 0; z < 20; ++z) {
        scan += std::to_string(25 + radius * std::sin(angle)) + " " +
                std::to_string(kRadius - radius * std::cos(angle)) + " " + std::to_string(0.1 * z) +
                "\n";
      }
    }
    for (int x = -20; x < 60; ++x) {  // the ground
      for (int y = -10; y < 50; ++y) {
        scan += std::to_string(x) + " " + std::to_string(y) + " 0\n";
      }
    }
    for (int y = -5; y <= 5; ++y) {
      for (int x = 0; x <= 16; ++x) {
        const std::string at = std::to_string(0.5 * x) + " " + std::to_string(0.25 * y) + " 1\n";
        trailer += at;
        if (x <= 8) tractor += at;
      }
    }
    put_bytes(folder / "scan.xyz", scan);
    put_bytes(folder / "path.txt", path);
    put_bytes(folder / "tractor.xyz", tractor);
    put_bytes(folder / "trailer.xyz", trailer);
    put_vehicle(kTrailer);
    REQUIRE(program("convert scan.xyz -o site.h5 --cell-points 256").exit_code == 0);
  }

  /// Writes road.json: the trailer, in this motion, and then its tractor.
  void put_vehicle(const std::string& motion) const {
    put_bytes(folder / "road.json",
              R"({"bodies": [{"name": "trailer", "model": "trailer.xyz", )" + motion +
                  R"(}, {"name": "tractor", "model": "tractor.xyz", "pivots": [3.8, 0]}]})");
  }
  Outcome program(const std::string& arguments) const {
    return run_program_at("env", folder,
                          "-C " + quoted(folder / "") + " '" CLEARWAY_PROGRAM "' " + arguments);
  }
  Outcome run(const std::string& arguments) const {
    return program(
        "run --env site.h5 --vehicle road.json --trajectory path.txt --radius 0.1 --threads 2 "
        "--first-pose --force " +
        arguments);
  }
  Outcome follow(const std::string& body, const std::string& more) const {
    return program("trajectory follow path.txt --vehicle road.json --body " + body + " --force " +
                   more);
  }

  static constexpr const char* kTrailer =
      R"("towed": {"by": "tractor", "at": -0.6, "pivots": [8, "0cm"]})";
  ScratchFolder folder;
};

}  // namespace

TEST_CASE("a towed trailer meets posts in a turn that one on the path passes") {
  const Turn turn;
  REQUIRE(turn.run("--clearance 0.5 -o towed.h5").exit_code == 0);
  const Result towed(turn.folder / "towed.h5");
  CHECK(towed.size() > 30);
  for (const auto body : towed.first_body()) CHECK(body == 0);
  turn.put_vehicle(R"("pivots": [-0.6, -8.6])");
  REQUIRE(turn.run("--clearance 0.5 -o pivots.h5").exit_code == 0);
  CHECK(Result(turn.folder / "pivots.h5").size() == 0);
}

TEST_CASE("trajectory follow writes the poses that a towed body has in a run") {
  const Turn turn;
  REQUIRE(turn.run("--clearance 0.5 -o towed.h5").exit_code == 0);
  const Outcome followed = turn.follow("trailer", "-o trailer.csv --json");
  REQUIRE(followed.exit_code == 0);
  CHECK_THAT(followed.err, Contains("bodies[0] (trailer)") && Contains("poses 0-"));
  const json report = json::parse(followed.out);
  CHECK(report["vehicle"] == "road.json");
  CHECK(report["body"] == "trailer");
  // The front pivot is 3.8 m ahead, so tractor and trailer end before the path does.
  CHECK(report["poses_in"] == 736);
  CHECK(report["poses_out"] == 698);
  CHECK(report["off_path"] == json::parse("[[698, 735]]"));
  CHECK(report["transient"][0][0] == 0);
  const std::string table = bytes_of(turn.folder / "trailer.csv");
  CHECK_THAT(table, Catch::StartsWith("path_pose,x,y,z,r00,r01,r02,r10,r11,r12,r20,r21,r22\n0,"));
  CHECK_THAT(table, Contains("\n697,"));
  const std::vector<Pose> poses = read_trajectory(turn.folder / "trailer.csv");
  REQUIRE(turn.follow("trailer", "-o trailer.txt").exit_code == 0);
  CHECK(read_trajectory(turn.folder / "trailer.txt") == poses);
  // A vehicle whose bodies have the written poses as their own finds the same.
  REQUIRE(turn.follow("tractor", "-o tractor.txt").exit_code == 0);
  std::string path = bytes_of(turn.folder / "path.txt");
  std::size_t end = 0;
  for (std::size_t line = 0; line < poses.size(); ++line) end = path.find('\n', end) + 1;
  put_bytes(turn.folder / "path.txt", path.substr(0, end));
  put_bytes(turn.folder / "road.json",
            R"({"bodies": [
                {"name": "trailer", "model": "trailer.xyz", "trajectory": "trailer.txt"},
                {"name": "tractor", "model": "tractor.xyz", "trajectory": "tractor.txt"}]})");
  REQUIRE(turn.run("--clearance 0.5 -o own.h5").exit_code == 0);
  const Result towed(turn.folder / "towed.h5"), own(turn.folder / "own.h5");
  CHECK(towed.source() == own.source());
  CHECK(towed.first_pose() == own.first_pose());
  CHECK(towed.clearance().distance == own.clearance().distance);
}

TEST_CASE("trajectory follow of a vehicle keeps stations and places bodies of every motion") {
  const Turn turn;
  std::string path = "station,x,y,z,r00,r01,r02,r10,r11,r12,r20,r21,r22\n";
  for (int i = 0; i <= 200; ++i) {
    path += std::to_string(1000 + i * 0.25) + "," + std::to_string(i * 0.25) +
            ",0,0,1,0,0,0,1,0,0,0,1\n";
  }
  put_bytes(turn.folder / "path.txt", path);
  put_bytes(turn.folder / "crane.txt", bytes_of(turn.folder / "path.txt"));
  put_bytes(turn.folder / "road.json",
            R"({"bodies": [
      {"name": "a", "model": "no.xyz", "at": 2}, {"name": "b", "model": "no.xyz"},
      {"name": "c", "model": "no.xyz", "trajectory": "crane.txt"},
      {"name": "d", "model": "no.xyz", "towed": {"by": "c", "at": -1, "pivots": [5, 0]}},
      {"name": "e", "model": "no.xyz", "towed": {"at": 0, "pivots": [5, 0]}}]})");
  // Models are not read. The third pose is at station 1000.5.
  for (const auto& [name, x] :
       {std::pair{"a", 2.5}, {"b", 0.5}, {"c", 0.5}, {"d", -5.5}, {"e", -4.5}}) {
    REQUIRE(turn.follow(name, "-o out.csv").exit_code == 0);
    PoseLabels labels;
    const auto poses = read_trajectory(turn.folder / "out.csv", {}, nullptr, &labels);
    CHECK(poses[2].translation[0] == Approx(x).margin(1e-12));
    REQUIRE(labels.station.size() == poses.size());
    CHECK(labels.station[2] == 1000.5);
    CHECK(poses.size() == (std::string(name) == "a" ? 193 : 201));
  }
}

TEST_CASE("shards of a towed vehicle merge to the bytes of its whole run") {
  const Turn turn;
  REQUIRE(turn.run("--clearance 0.5 -o whole.h5").exit_code == 0);
  for (const std::string part : {"1", "2"}) {
    REQUIRE(turn.run("--clearance 0.5 --shard " + part + "/2 -o part" + part + ".h5").exit_code ==
            0);
  }
  REQUIRE(turn.program("merge part1.h5 part2.h5 -o merged.h5").exit_code == 0);
  CHECK(bytes_of(turn.folder / "merged.h5") == bytes_of(turn.folder / "whole.h5"));
}

TEST_CASE("a towed vehicle is searched between poses") {
  const Turn turn;
  const Outcome found = turn.run("--between-poses -o between.h5");
  INFO(found.err);
  REQUIRE(found.exit_code == 0);
  CHECK(Result(turn.folder / "between.h5").size() > 30);
}

TEST_CASE("conflicts, report and campaign know a towed trailer") {
  const Turn turn;
  REQUIRE(turn.run("--clearance 0.5 -o out.h5").exit_code == 0);
  const std::string vehicle = " --vehicle road.json --trajectory path.txt ";
  REQUIRE(turn.program("conflicts out.h5" + vehicle + "--min-points 1 -o found.json").exit_code ==
          0);
  const json found = json::parse(bytes_of(turn.folder / "found.json"));
  REQUIRE(found["conflicts"].size() > 0);
  CHECK(found["conflicts"][0]["body_name"] == "trailer");
  CHECK(found["conflicts"][0]["side"] == "left");
  REQUIRE(turn.program("report out.h5 --env site.h5" + vehicle + "-o page.html").exit_code == 0);
  CHECK_THAT(bytes_of(turn.folder / "page.html"), Contains("trailer"));
  // Another hitch is another vehicle.
  turn.put_vehicle(R"("towed": {"by": "tractor", "at": -0.7, "pivots": [8, 0]})");
  CHECK(turn.program("conflicts out.h5" + vehicle + "-o other.json").exit_code == 3);
  turn.put_vehicle(Turn::kTrailer);
  put_bytes(
      turn.folder / "campaign.json",
      R"({"name": "one", "environments": {"site": "site.h5"}, "vehicles": {"road": "road.json"},
                "routes": {"turn": "path.txt"}, "radii": [0.1],
                "query": {"first_pose": true, "clearance": 0.5},
                "outputs": {"conflicts": ["csv"]}})");
  REQUIRE(turn.program("campaign plan campaign.json -o all").exit_code == 0);
  const Outcome campaign = turn.program("campaign run all --all");
  INFO(campaign.out + campaign.err);
  CHECK(campaign.exit_code == 0);
  CHECK(bytes_of(turn.folder / "all/runs/road/turn/0.1/out.h5") ==
        bytes_of(turn.folder / "out.h5"));
}

TEST_CASE("every complaint about a towed body names the key") {
  const Turn turn;
  const auto refused = [&](const std::string& motion, const std::string& words) {
    turn.put_vehicle(motion);
    const Outcome outcome = turn.run("-o out.h5");
    CHECK(outcome.exit_code == 3);
    CHECK_THAT(outcome.err, Contains("road.json: bodies[0]" + words));
  };
  const auto tow = [](const std::string& by, const std::string& pivots) {
    return R"("towed": {"by": )" + by + R"(, "at": -0.6, "pivots": )" + pivots + "}";
  };
  refused(R"("towed": 3)", ".towed: expected");
  refused(R"("towed": {"at": 1})", ".towed.pivots: is missing");
  refused(R"("towed": {"pivots": [8, 0]})", ".towed.at: is missing");
  refused(R"("towed": {"at": 0, "pivots": [8, 0], "pivot": 3})", ".towed.pivot: unknown key");
  refused(tow("\"lorry\"", "[8, 0]"), ".towed.by: no body is named \"lorry\"");
  refused(tow("\"trailer\"", "[8, 0]"), ".towed.by: the body would tow itself");
  refused(tow("7", "[8, 0]"), ".towed.by: expected");
  refused(tow("\"tractor\"", "[8]"), ".towed.pivots: expected two lengths");
  refused(tow("\"tractor\"", "[8, 8]"), ".towed.pivots: expected the hitch");
  refused(tow("\"tractor\"", "[0, 8]"), ".towed.pivots: expected the hitch");
  refused(tow("\"tractor\"", "[8, \"x\"]"), ".towed.pivots[1]: is \"x\", expected a length");
  refused(tow("\"tractor\"", "[1e308, 0]"), ".towed.pivots[0]: expected at most 1000 km");
  for (const char* more :
       {R"("at": 1, )", R"("pivots": [1, -1], )", R"("trajectory": "a.txt", )"}) {
    refused(more + std::string(Turn::kTrailer), ": a body moves in one way");
  }
  put_bytes(turn.folder / "road.json",
            R"({"bodies": [
      {"name": "a", "model": "trailer.xyz", "towed": {"by": "b", "at": 0, "pivots": [1, 0]}},
      {"name": "b", "model": "trailer.xyz", "towed": {"by": "a", "at": 0, "pivots": [1, 0]}}]})");
  const Outcome ring = turn.run("-o out.h5");
  CHECK(ring.exit_code == 3);
  CHECK_THAT(ring.err, Contains("bodies[0].towed.by: ") && Contains("in a ring"));
  turn.put_vehicle(Turn::kTrailer);
  const Outcome nobody = turn.follow("lorry", "-o out.txt");
  CHECK(nobody.exit_code == 2);
  CHECK_THAT(nobody.err, Contains("expected one of trailer, tractor"));
  CHECK(turn.program("trajectory follow path.txt --vehicle road.json -o out.txt").exit_code == 2);
  CHECK(turn.follow("trailer", "--at 2 -o out.txt").exit_code == 2);
}

TEST_CASE("a trailer that is pushed is refused with its key and the place") {
  const Turn turn;
  std::string path;
  for (int i = 0; i <= 300; ++i) path += line_of(0, 0.1 * i, 0);
  for (int i = 0; i <= 20; ++i) path += line_of(0, 30 - 0.1 * i, 0);
  put_bytes(turn.folder / "path.txt", path);
  turn.put_vehicle(R"("towed": {"at": -0.6, "pivots": [8, 0]})");
  const Outcome outcome = turn.run("-o out.h5");
  CHECK(outcome.exit_code == 3);
  CHECK_THAT(outcome.err, Contains("road.json: bodies[0].towed: its hitch goes backwards") &&
                              Contains("from pose 301 of the path") && Contains("30 m along it"));
}
