#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "clearway/trajectory.hpp"
#include "core/util/progress.hpp"
#include "io/paths/trajectory_file.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr double kRadius = 150;

/// A folder with path.txt, which goes along a circle with a pose every 0.1 m.
struct Circle : Workplace {
  Circle() {
    std::vector<Pose> poses;
    for (int i = 0; i < 801; ++i) {
      const double angle = 0.1 * i / kRadius;
      poses.push_back(
          rotation({0, 0, 1}, angle, {kRadius * std::sin(angle), -kRadius * std::cos(angle), 2}));
    }
    NoProgress progress;
    write_trajectory(poses, File::create(folder / "path.txt"), progress);
  }

  Outcome follow(const std::string& more, const std::string& in = "path.txt") const {
    return run("trajectory follow " + in + " -o out.txt " + more);
  }
  std::vector<Pose> out() const { return read_trajectory(folder / "out.txt"); }
};

}  // namespace

TEST_CASE("trajectory follow writes the chords of a circle") {
  const Circle circle;
  const Outcome outcome = require_success(circle.follow("--pivots 10.05,-10.05 --json"));
  check_says(outcome.err, "202 of 801 poses of the path (poses 0-100, 700-800, from 0)");
  const auto json = json_of(outcome);
  check_json(json, R"({"poses_in": 801, "poses_out": 599, "turned": []})");
  check_near(json, "/length", 80);
  CHECK(json["pivots"] == nlohmann::json{10.05, -10.05});
  CHECK(json["off_path"] == nlohmann::json::parse("[[0, 100], [700, 800]]"));
  const auto poses = circle.out();
  REQUIRE(poses.size() == 599);
  const double chord = 2 * kRadius * std::sin(10.05 / kRadius);
  const double middle = std::sqrt(kRadius * kRadius - chord * chord / 4);
  for (std::size_t k = 10; k < 589; ++k) {
    const double* at = poses[k].translation;
    CHECK(std::abs(std::hypot(at[0], at[1]) - middle) < 1e-9);
  }
}

TEST_CASE("trajectory follow takes stations ahead and behind with units") {
  const Circle circle;
  require_success(circle.follow("--at 2.5"));
  const std::string ahead = circle.bytes("out.txt");
  CHECK(circle.out().size() == 776);
  require_success(circle.follow("--at=250cm --force"));
  check_same(circle.bytes("out.txt"), ahead);
  require_success(circle.follow("--at -2.5 --force --threads 1"));
  CHECK(circle.out().size() == 776);
  check_json(json_of(require_success(circle.follow("--at 0 --force --json"))), R"({"at": 0})");
  check_same(circle.bytes("out.txt"), circle.bytes("path.txt"));
}

TEST_CASE("trajectory follow refuses what it cannot use and leaves no output") {
  const Circle circle;
  const auto refused = [&](const std::string& more, int code, const std::string& words,
                           const std::string& in = "path.txt") {
    const Outcome outcome = circle.follow(more, in);
    CHECK(outcome.exit_code == code);
    check_says(outcome.err, words);
    CHECK_FALSE(circle.has("out.txt"));
    CHECK_FALSE(circle.has("out.txt.partial"));
  };
  refused("", 2, "--at or --pivots");
  refused("--at 1 --pivots 1,-1", 2, "--pivots");
  refused("--at far", 2, "--at");
  refused("--at inf", 2, "--at");
  refused("--pivots 1", 2, "two numbers of metres");
  refused("--pivots 1,2,3", 2, "two numbers of metres");
  refused("--pivots 1,nan", 2, "two numbers of metres");
  refused("--pivots 4,400cm", 2, "two different places");
  refused("--at 81", 3, "80 m long");
  refused("--pivots 41,-41", 3, "80 m long");
  refused("--at 1", 4, "missing.txt", "missing.txt");
  circle.put("empty.txt", "");
  refused("--at 1", 3, "no poses", "empty.txt");
  circle.put("mirror.txt", "-1 0 0 0 0 1 0 0 0 0 1 0\n-1 0 0 9 0 1 0 0 0 0 1 0\n");
  refused("--pivots 1,-1 --allow-non-rigid", 3, "mirror.txt: the poses mirror", "mirror.txt");
  circle.put("turns.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n-1 0 0 9 0 1 0 0 0 0 1 0\n");
  refused("--at 1 --allow-non-rigid", 3, "turns.txt: poses 0 and 1", "turns.txt");
}

TEST_CASE("trajectory follow overwrites neither outputs nor inputs") {
  const Circle circle;
  circle.put("out.txt", "mine");
  check_outcome(circle.follow("--at 1"), 2);
  check_same(circle.bytes("out.txt"), "mine");
  check_outcome(circle.follow("--at 1 --force"), 0);
  const std::string before = circle.bytes("path.txt");
  check_outcome(circle.run("trajectory follow path.txt -o path.txt --at 1 --force"), 2);
  check_same(circle.bytes("path.txt"), before);
}

TEST_CASE("trajectory follow keeps stations, those of the place that the body is at") {
  const Circle circle;
  const std::vector<Pose> path = read_trajectory(circle.folder / "path.txt");
  std::vector<double> stations;
  for (std::size_t i = 0; i < path.size(); ++i)
    stations.push_back(500 + 0.2 * static_cast<double>(i));
  NoProgress progress;
  write_trajectory_table(path, {.station = stations}, {.unit = FileUnit::exactly(1)},
                         File::create(circle.folder / "line.csv"), progress);
  const auto check = [&](const std::string& how, double first, std::size_t count) {
    require_success(circle.follow(how, "line.csv"));
    PoseLabels labels;
    const auto poses = read_trajectory(circle.folder / "out.txt", {}, nullptr, &labels);
    CHECK(poses.size() == count);
    REQUIRE(labels.station.size() == count);
    for (std::size_t i = 0; i < count; ++i) {
      CHECK(labels.station[i] == Approx(first + 0.2 * static_cast<double>(i)).margin(1e-6));
    }
  };
  check("--at 10.05 --force", 520.1, 700);  // poses 0 to 699, 10.05 m ahead
  check("--pivots 5,-5 --force", 510, 701);
}
