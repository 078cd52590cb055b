#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "clearway/trajectory.hpp"
#include "core/util/progress.hpp"
#include "io/paths/trajectory_file.hpp"
#include "support/scenes.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

namespace {

constexpr double kRadius = 150;

/// A folder with path.txt, which goes along a circle with a pose every 0.1 m.
struct Circle {
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

  std::string path(const std::string& name) const { return quoted(folder / name); }
  Outcome follow(const std::string& more, const std::string& in = "path.txt") const {
    return run_program(folder,
                       "trajectory follow " + path(in) + " -o " + path("out.txt") + " " + more);
  }
  std::vector<Pose> out() const { return read_trajectory(folder / "out.txt"); }

  ScratchFolder folder;
};

}  // namespace

TEST_CASE("trajectory follow writes the chords of a circle") {
  const Circle circle;
  const Outcome outcome = circle.follow("--pivots 10.05,-10.05 --json");
  REQUIRE(outcome.exit_code == 0);
  CHECK_THAT(outcome.err, Contains("202 of 801 poses of the path (poses 0-100, 700-800, from 0)"));
  const auto json = nlohmann::json::parse(outcome.out);
  CHECK(json["poses_in"] == 801);
  CHECK(json["poses_out"] == 599);
  CHECK(json["length"] == Approx(80));
  CHECK(json["pivots"] == nlohmann::json{10.05, -10.05});
  CHECK(json["off_path"] == nlohmann::json::parse("[[0, 100], [700, 800]]"));
  CHECK(json["turned"].empty());
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
  REQUIRE(circle.follow("--at 2.5").exit_code == 0);
  const std::string ahead = bytes_of(circle.folder / "out.txt");
  CHECK(circle.out().size() == 776);
  REQUIRE(circle.follow("--at=250cm --force").exit_code == 0);
  CHECK(bytes_of(circle.folder / "out.txt") == ahead);
  REQUIRE(circle.follow("--at -2.5 --force --threads 1").exit_code == 0);
  CHECK(circle.out().size() == 776);
  const Outcome there = circle.follow("--at 0 --force --json");
  REQUIRE(there.exit_code == 0);
  CHECK(nlohmann::json::parse(there.out)["at"] == 0);
  CHECK(bytes_of(circle.folder / "out.txt") == bytes_of(circle.folder / "path.txt"));
}

TEST_CASE("trajectory follow refuses what it cannot use and leaves no output") {
  const Circle circle;
  const auto refused = [&](const std::string& more, int code, const std::string& words,
                           const std::string& in = "path.txt") {
    const Outcome outcome = circle.follow(more, in);
    CHECK(outcome.exit_code == code);
    CHECK_THAT(outcome.err, Contains(words));
    CHECK_FALSE(std::filesystem::exists(circle.folder / "out.txt"));
    CHECK_FALSE(std::filesystem::exists(circle.folder / "out.txt.partial"));
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
  put_bytes(circle.folder / "empty.txt", "");
  refused("--at 1", 3, "no poses", "empty.txt");
  put_bytes(circle.folder / "mirror.txt", "-1 0 0 0 0 1 0 0 0 0 1 0\n-1 0 0 9 0 1 0 0 0 0 1 0\n");
  refused("--pivots 1,-1 --allow-non-rigid", 3, "mirror.txt: the poses mirror", "mirror.txt");
  put_bytes(circle.folder / "turns.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n-1 0 0 9 0 1 0 0 0 0 1 0\n");
  refused("--at 1 --allow-non-rigid", 3, "turns.txt: poses 0 and 1", "turns.txt");
}

TEST_CASE("trajectory follow overwrites neither outputs nor inputs") {
  const Circle circle;
  put_bytes(circle.folder / "out.txt", "mine");
  CHECK(circle.follow("--at 1").exit_code == 2);
  CHECK(bytes_of(circle.folder / "out.txt") == "mine");
  CHECK(circle.follow("--at 1 --force").exit_code == 0);
  const std::string before = bytes_of(circle.folder / "path.txt");
  const Outcome outcome =
      run_program(circle.folder, "trajectory follow " + circle.path("path.txt") + " -o " +
                                     circle.path("path.txt") + " --at 1 --force");
  CHECK(outcome.exit_code == 2);
  CHECK(bytes_of(circle.folder / "path.txt") == before);
}

TEST_CASE("trajectory follow keeps stations, those of the place that the body is at") {
  const Circle circle;
  const std::vector<Pose> path = read_trajectory(circle.folder / "path.txt");
  std::vector<double> stations;
  for (std::size_t i = 0; i < path.size(); ++i)
    stations.push_back(500 + 0.2 * static_cast<double>(i));
  NoProgress progress;
  write_trajectory_table(path, {.station = stations}, {.in_metres = true},
                         File::create(circle.folder / "line.csv"), progress);
  const auto check = [&](const std::string& how, double first, std::size_t count) {
    const Outcome outcome = circle.follow(how, "line.csv");
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
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
