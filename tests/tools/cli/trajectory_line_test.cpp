#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "clearway/line.hpp"
#include "clearway/trajectory.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

namespace {

/// A folder with route.csv.
struct Route {
  explicit Route(const std::string& text) : input(folder / "route.csv") { put_bytes(input, text); }

  Outcome make(const std::string& more) const {
    return run_program(folder, "trajectory line " + quoted(input) + " -o " +
                                   quoted(folder / "out.csv") + " " + more);
  }
  std::string out() const { return bytes_of(folder / "out.csv"); }

  ScratchFolder folder;
  std::filesystem::path input;
};

const std::string kCorner = "x,y,z,station\n0,0,5,1000\n20,0,5,1020\n20,30,6,1050\n";

}  // namespace

TEST_CASE("trajectory line writes poses and stations that read back unchanged") {
  const Route route(kCorner);
  const Outcome outcome = route.make("--corner-radius 6 --json");
  REQUIRE(outcome.exit_code == 0);
  CHECK(route.out().starts_with(
      "station [m],x [m],y [m],z [m],r00,r01,r02,r10,r11,r12,r20,r21,r22\n1000,0,0,5,1,0,0,"));
  CHECK_FALSE(route.out().find("-0,") != std::string::npos);
  PoseLabels made_labels, labels;
  std::vector<Message> remarks;
  const auto made = read_line(route.input, {.corner_radius = 6}, nullptr, &made_labels);
  const auto read = read_trajectory(route.folder / "out.csv", {}, &remarks, &labels);
  CHECK(remarks.empty());
  CHECK(labels.station == made_labels.station);
  CHECK(read == made);
  const auto json = nlohmann::json::parse(outcome.out);
  CHECK(json["format"] == "csv");
  CHECK(json["vertices"] == 3);
  CHECK(json["arcs"] == 1);
  CHECK(json["length"] == Approx(38 + 3 * 3.14159265358979));
  CHECK(json["poses"] == made.size());
  CHECK(json["first_station"] == 1000);
  CHECK(json["last_station"] == 1050);
  CHECK(json["notes"][0]["code"] == "line-rounded");
  CHECK(json["warnings"].empty());
  const Outcome info =
      run_program(route.folder, "trajectory info " + quoted(route.folder / "out.csv"));
  CHECK(info.exit_code == 0);
  CHECK_THAT(info.err, !Contains("warning"));
}

TEST_CASE("trajectory line takes all of its options") {
  const Route route("x,y,cant [mm]\n0,0,30\n1000,0,30\n");
  const Outcome outcome = route.make(
      "--step 5cm --reverse --height 2 --trajectory-unit mm --cant left-rail "
      "--rail-distance 1.5 --json");
  REQUIRE(outcome.exit_code == 0);
  const auto poses = read_trajectory(route.folder / "out.csv");
  REQUIRE(poses.size() == 21);
  CHECK(poses[0].translation[0] == 1);
  CHECK(poses[0].translation[2] == Approx(2 - 0.015));
  CHECK(poses[0].rotation[0] == -1);
  CHECK(route.out().starts_with("x [m],y [m],z [m],r00"));
  const auto json = nlohmann::json::parse(outcome.out);
  CHECK(json["first_station"].is_null());
  CHECK(json["metres_per_unit"] == 0.001);
}

TEST_CASE("trajectory line refuses what it cannot use, with advice, and leaves no output") {
  const Route route(kCorner);
  const auto refused = [&](const std::string& more, int code, const std::string& words) {
    const Outcome outcome = route.make(more);
    CHECK(outcome.exit_code == code);
    CHECK_THAT(outcome.err, Contains(words));
    CHECK_FALSE(std::filesystem::exists(route.folder / "out.csv"));
    CHECK_FALSE(std::filesystem::exists(route.folder / "out.csv.partial"));
  };
  refused("", 3, "--corner-radius METRES puts arcs");
  refused("--corner-radius 25", 3, "A radius of 20 m fits everywhere");
  refused("--corner-radius 0", 2, "--corner-radius");
  refused("--step -1", 2, "--step");
  refused("--step 1e-7 --corner-radius 6", 2, "at most 10,000,000");
  refused("--height 3 --corner-radius 6", 2, "have heights");
  refused("--cant file --corner-radius 6", 2, "--cant");
  refused("--rail-distance 0", 2, "--rail-distance");
  refused("--trajectory-unit parsec", 2, "--trajectory-unit");
  put_bytes(route.input, "x,y\n0,0\n20,0\n");
  refused("", 3, "--height gives one for all of it, and --on-ground");
  put_bytes(route.input, "x,y\n9.1,48\n9.2,48\n");
  refused("--height 3", 3, "--trajectory-unit says it");
  put_bytes(route.input, kCorner);
  const Outcome same = run_program(route.folder, "trajectory line " + quoted(route.input) + " -o " +
                                                     quoted(route.input) + " --force");
  CHECK(same.exit_code == 2);
  CHECK(bytes_of(route.input) == kCorner);
  put_bytes(route.folder / "out.csv", "mine");
  CHECK(route.make("--corner-radius 6").exit_code == 2);
  CHECK(route.out() == "mine");
  CHECK(route.make("--corner-radius 6 --force").exit_code == 0);
  put_bytes(route.input, "x,y\n0,0\n100,0\n200,20\n300,60\n");
  CHECK_THAT(route.make("--height 3 --force").err, Contains("--corner-radius keeps legs straight"));
}

TEST_CASE("trajectory line puts a path on the ground of a store") {
  const Route route("x,y,station\n1,0,100\n9,0,108\n");
  std::string ground;
  for (int i = 0; i < 100; ++i) {
    for (int j = -15; j <= 15; ++j) {
      ground += std::to_string(0.1 * i) + " " + std::to_string(0.1 * j) + " " +
                std::to_string(4 + 0.002 * j) + "\n";
    }
  }
  put_bytes(route.folder / "ground.xyz", ground);
  const auto site = route.folder / "site.h5";
  REQUIRE(run_program(route.folder, "convert " + quoted(route.folder / "ground.xyz") + " -o " +
                                        quoted(site) + " --unit m")
              .exit_code == 0);
  const std::string on = "--on-ground " + quoted(site);
  const Outcome outcome = route.make(on + " --track 1600mm --json");
  REQUIRE(outcome.exit_code == 0);
  CHECK_THAT(outcome.err, Contains("17 of 17 on the right") && Contains("parked car"));
  const auto json = nlohmann::json::parse(outcome.out);
  CHECK(json["ground"] ==
        nlohmann::json{
            {"places", 17}, {"left", 17}, {"right", 17}, {"risen", 0}, {"longest_bridged", 0.0}});
  CHECK(json["notes"][0]["code"] == "on-ground");
  for (const Pose& pose : read_trajectory(route.folder / "out.csv")) {
    CHECK(pose.translation[2] == Approx(4));
    CHECK(pose.rotation[7] == Approx(0.02).epsilon(0.01));
  }
  CHECK(route.make(on + " --force").exit_code == 2);
  CHECK(route.make("--track 2 --height 3 --force").exit_code == 2);
  CHECK(route.make(on + " --track 2 --force --env " + quoted(site)).exit_code == 2);
  const Outcome wide = route.make(on + " --track 12 --force");
  CHECK(wide.exit_code == 3);
  CHECK_THAT(wide.err, Contains("no ground was found under the left wheels"));
  const Outcome over = run_program(route.folder, "trajectory line " + quoted(route.input) + " " +
                                                     on + " --track 1 --force -o " + quoted(site));
  CHECK(over.exit_code == 2);
}

TEST_CASE("trajectory line takes the unit of a store") {
  const Route route("x,y\n0,0\n100,0\n");
  put_bytes(route.folder / "points.xyz", "0 0 0\n1 1 1\n2 1 0\n");
  const auto store_in = [&](const std::string& unit) {
    const auto store = route.folder / (unit + ".h5");
    REQUIRE(run_program(route.folder, "convert " + quoted(route.folder / "points.xyz") + " -o " +
                                          quoted(store) + " --unit " + unit)
                .exit_code == 0);
    return "--height 0 --force --env " + quoted(store);
  };
  const auto last_x = [&] {
    return read_trajectory(route.folder / "out.csv").back().translation[0];
  };
  REQUIRE(route.make(store_in("m")).exit_code == 0);
  CHECK(last_x() == 100);
  const Outcome feet = route.make(store_in("us-ft"));
  CHECK(feet.exit_code == 0);
  CHECK_THAT(feet.err, Contains("multiplied by 0.30480061 "));
  CHECK(last_x() == Approx(30.48006096).epsilon(1e-9));
  CHECK(route.make("--height 0 --force --env " + quoted(route.folder / "none.h5")).exit_code == 4);
}
