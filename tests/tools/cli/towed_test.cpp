// Towed bodies as a user runs them: in a run, in shards, and in all that comes after.
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "clearway/result.hpp"
#include "clearway/trajectory.hpp"
#include "support/catch.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
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
struct Turn : Workplace {
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
    put("scan.xyz", scan);
    put("path.txt", path);
    put("tractor.xyz", tractor);
    put("trailer.xyz", trailer);
    put_vehicle(kTrailer);
    require_success(run("convert scan.xyz -o site.h5 --cell-points 256"));
  }

  /// Writes road.json: the trailer, in this motion, and then its tractor.
  void put_vehicle(const std::string& motion) const {
    put("road.json", R"({"bodies": [{"name": "trailer", "model": "trailer.xyz", )" + motion +
                         R"(}, {"name": "tractor", "model": "tractor.xyz", "pivots": [3.8, 0]}]})");
  }
  Outcome search(const std::string& arguments) const {
    return run(
        "run --env site.h5 --vehicle road.json --trajectory path.txt --radius 0.1 --threads 2 "
        "--first-pose --force " +
        arguments);
  }
  Outcome follow(const std::string& body, const std::string& more) const {
    return run("trajectory follow path.txt --vehicle road.json --body " + body + " --force " +
               more);
  }

  static constexpr const char* kTrailer =
      R"("towed": {"by": "tractor", "at": -0.6, "pivots": [8, "0cm"]})";
};

}  // namespace

TEST_CASE("a towed trailer meets posts in a turn that one on the path passes") {
  const Turn turn;
  require_success(turn.search("--clearance 0.5 -o towed.h5"));
  const Result towed(turn.folder / "towed.h5");
  CHECK(towed.size() > 30);
  for (const auto body : towed.first_body()) CHECK(body == 0);
  turn.put_vehicle(R"("pivots": [-0.6, -8.6])");
  require_success(turn.search("--clearance 0.5 -o pivots.h5"));
  CHECK(Result(turn.folder / "pivots.h5").size() == 0);
}

TEST_CASE("trajectory follow writes the poses that a towed body has in a run") {
  const Turn turn;
  require_success(turn.search("--clearance 0.5 -o towed.h5"));
  const Outcome followed = require_success(turn.follow("trailer", "-o trailer.csv --json"));
  check_says(followed.err, "bodies[0] (trailer) ... poses 0-");
  const json report = json_of(followed);
  check_json(report, R"({"vehicle": "road.json", "body": "trailer"})");
  // The front pivot is 3.8 m ahead, so tractor and trailer end before the path does.
  check_json(report, R"({
    "poses_in": 736, "poses_out": 698, "off_path": [[698, 735]], "transient": {"0": {"0": 0}}})");
  const std::string table = turn.bytes("trailer.csv");
  CHECK_THAT(table, StartsWith("path_pose,x,y,z,r00,r01,r02,r10,r11,r12,r20,r21,r22\n0,"));
  check_says(table, "\n697,");
  const std::vector<Pose> poses = read_trajectory(turn.folder / "trailer.csv");
  require_success(turn.follow("trailer", "-o trailer.txt"));
  CHECK(read_trajectory(turn.folder / "trailer.txt") == poses);
  // A vehicle whose bodies have the written poses as their own finds the same.
  require_success(turn.follow("tractor", "-o tractor.txt"));
  std::string path = turn.bytes("path.txt");
  std::size_t end = 0;
  for (std::size_t line = 0; line < poses.size(); ++line) end = path.find('\n', end) + 1;
  turn.put("path.txt", path.substr(0, end));
  turn.put("road.json", R"({"bodies": [
                {"name": "trailer", "model": "trailer.xyz", "trajectory": "trailer.txt"},
                {"name": "tractor", "model": "tractor.xyz", "trajectory": "tractor.txt"}]})");
  require_success(turn.search("--clearance 0.5 -o own.h5"));
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
  turn.put("path.txt", path);
  turn.put("crane.txt", turn.bytes("path.txt"));
  turn.put("road.json", R"({"bodies": [
      {"name": "a", "model": "no.xyz", "at": 2}, {"name": "b", "model": "no.xyz"},
      {"name": "c", "model": "no.xyz", "trajectory": "crane.txt"},
      {"name": "d", "model": "no.xyz", "towed": {"by": "c", "at": -1, "pivots": [5, 0]}},
      {"name": "e", "model": "no.xyz", "towed": {"at": 0, "pivots": [5, 0]}}]})");
  // Models are not read. The third pose is at station 1000.5.
  for (const auto& [name, x] :
       {std::pair{"a", 2.5}, {"b", 0.5}, {"c", 0.5}, {"d", -5.5}, {"e", -4.5}}) {
    require_success(turn.follow(name, "-o out.csv"));
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
  require_success(turn.search("--clearance 0.5 -o whole.h5"));
  for (const std::string part : {"1", "2"}) {
    require_success(turn.search("--clearance 0.5 --shard " + part + "/2 -o part" + part + ".h5"));
  }
  turn.succeed("merge part1.h5 part2.h5 -o merged.h5");
  check_same(turn.bytes("merged.h5"), turn.bytes("whole.h5"));
}

TEST_CASE("a towed vehicle is searched between poses") {
  const Turn turn;
  require_success(turn.search("--between-poses -o between.h5"));
  CHECK(Result(turn.folder / "between.h5").size() > 30);
}

TEST_CASE("conflicts, report and campaign know a towed trailer") {
  const Turn turn;
  require_success(turn.search("--clearance 0.5 -o out.h5"));
  const std::string vehicle = " --vehicle road.json --trajectory path.txt ";
  turn.succeed("conflicts out.h5" + vehicle + "--min-points 1 -o found.json");
  const json found = json::parse(turn.bytes("found.json"));
  REQUIRE(found["conflicts"].size() > 0);
  check_json(found, R"({"conflicts": {"0": {"body_name": "trailer", "side": "left"}}})");
  turn.succeed("report out.h5 --env site.h5" + vehicle + "-o page.html");
  check_says(turn.bytes("page.html"), "trailer");
  // Another hitch is another vehicle.
  turn.put_vehicle(R"("towed": {"by": "tractor", "at": -0.7, "pivots": [8, 0]})");
  check_outcome(turn.run("conflicts out.h5" + vehicle + "-o other.json"), 3);
  turn.put_vehicle(Turn::kTrailer);
  put_bytes(
      turn.folder / "campaign.json",
      R"({"name": "one", "environments": {"site": "site.h5"}, "vehicles": {"road": "road.json"},
                "routes": {"turn": "path.txt"}, "radii": [0.1],
                "query": {"first_pose": true, "clearance": 0.5},
                "outputs": {"conflicts": ["csv"]}})");
  turn.succeed("campaign plan campaign.json -o all");
  const Outcome campaign = turn.run("campaign run all --all");
  INFO(campaign.out + campaign.err);
  check_outcome(campaign, 0);
  check_same(turn.bytes("all/runs/road/turn/0.1/out.h5"), turn.bytes("out.h5"));
}

TEST_CASE("every complaint about a towed body names the key") {
  const Turn turn;
  const auto refused = [&](const std::string& motion, const std::string& words) {
    turn.put_vehicle(motion);
    check_outcome(turn.search("-o out.h5"), 3, "road.json: bodies[0]" + words);
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
  turn.put("road.json", R"({"bodies": [
      {"name": "a", "model": "trailer.xyz", "towed": {"by": "b", "at": 0, "pivots": [1, 0]}},
      {"name": "b", "model": "trailer.xyz", "towed": {"by": "a", "at": 0, "pivots": [1, 0]}}]})");
  const Outcome ring = turn.search("-o out.h5");
  check_outcome(ring, 3, "bodies[0].towed.by:  ... in a ring");
  turn.put_vehicle(Turn::kTrailer);
  check_outcome(turn.follow("lorry", "-o out.txt"), 2, "expected one of trailer, tractor");
  check_outcome(turn.run("trajectory follow path.txt --vehicle road.json -o out.txt"), 2);
  check_outcome(turn.follow("trailer", "--at 2 -o out.txt"), 2);
}

TEST_CASE("a trailer that is pushed is refused with its key and the place") {
  const Turn turn;
  std::string path;
  for (int i = 0; i <= 300; ++i) path += line_of(0, 0.1 * i, 0);
  for (int i = 0; i <= 20; ++i) path += line_of(0, 30 - 0.1 * i, 0);
  turn.put("path.txt", path);
  turn.put_vehicle(R"("towed": {"at": -0.6, "pivots": [8, 0]})");
  check_outcome(turn.search("-o out.h5"), 3,
                "road.json: bodies[0].towed: its hitch goes backwards ... from pose 301 of the "
                "path ... 30 m along it");
}
