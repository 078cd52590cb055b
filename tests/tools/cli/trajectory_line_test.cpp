#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "clearway/line.hpp"
#include "clearway/trajectory.hpp"
#include "support/catch.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A folder with route.csv.
struct Route : Workplace {
  explicit Route(const std::string& text) : input(folder / "route.csv") { put_bytes(input, text); }

  Outcome make(const std::string& more) const {
    return run("trajectory line " + quoted(input) + " -o out.csv " + more);
  }
  std::string out() const { return bytes("out.csv"); }

  std::filesystem::path input;
};

const std::string kCorner = "x,y,z,station\n0,0,5,1000\n20,0,5,1020\n20,30,6,1050\n";

}  // namespace

TEST_CASE("trajectory line writes poses and stations that read back unchanged") {
  const Route route(kCorner);
  const Outcome outcome = require_success(route.make("--corner-radius 6 --json"));
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
  const auto json = json_of(outcome);
  check_json(json, R"({
    "format": "csv", "vertices": 3, "arcs": 1, "first_station": 1000, "last_station": 1050,
    "notes": {"0": {"code": "line-rounded"}}, "warnings": []})");
  check_near(json, "/length", 38 + 3 * 3.14159265358979);
  CHECK(json["poses"] == made.size());
  const Outcome info = route.run("trajectory info out.csv");
  check_outcome(info, 0);
  check_lacks(info.err, "warning");
}

TEST_CASE("trajectory line takes all of its options") {
  const Route route("x,y,cant [mm]\n0,0,30\n1000,0,30\n");
  const Outcome outcome =
      require_success(route.make("--step 5cm --reverse --height 2 --trajectory-unit mm --cant "
                                 "left-rail --rail-distance 1.5 --json"));
  const auto poses = read_trajectory(route.folder / "out.csv");
  REQUIRE(poses.size() == 21);
  CHECK(poses[0].translation[0] == 1);
  CHECK(poses[0].translation[2] == Approx(2 - 0.015));
  CHECK(poses[0].rotation[0] == -1);
  CHECK(route.out().starts_with("x [m],y [m],z [m],r00"));
  const auto json = json_of(outcome);
  check_json(json, R"({"first_station": null, "metres_per_unit": 0.001})");
}

TEST_CASE("trajectory line refuses what it cannot use, with advice, and leaves no output") {
  const Route route(kCorner);
  const auto refused = [&](const std::string& more, int code, const std::string& words) {
    const Outcome outcome = route.make(more);
    CHECK(outcome.exit_code == code);
    check_says(outcome.err, words);
    CHECK_FALSE(route.has("out.csv"));
    CHECK_FALSE(route.has("out.csv.partial"));
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
  check_outcome(route.run("trajectory line " + quoted(route.input) + " -o " + quoted(route.input) +
                          " --force"),
                2);
  check_same(bytes_of(route.input), kCorner);
  route.put("out.csv", "mine");
  check_outcome(route.make("--corner-radius 6"), 2);
  CHECK(route.out() == "mine");
  check_outcome(route.make("--corner-radius 6 --force"), 0);
  put_bytes(route.input, "x,y\n0,0\n100,0\n200,20\n300,60\n");
  check_says(route.make("--height 3 --force").err, "--corner-radius keeps legs straight");
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
  route.put("ground.xyz", ground);
  const auto site = route.folder / "site.h5";
  require_success(route.run("convert ground.xyz -o " + quoted(site) + " --unit m"));
  const std::string on = "--on-ground " + quoted(site);
  const Outcome outcome = require_success(route.make(on + " --track 1600mm --json"));
  check_says(outcome.err, "17 of 17 on the right ... parked car");
  const auto json = json_of(outcome);
  CHECK(json["ground"] ==
        nlohmann::json{
            {"places", 17}, {"left", 17}, {"right", 17}, {"risen", 0}, {"longest_bridged", 0.0}});
  check_json(json, R"({"notes": {"0": {"code": "on-ground"}}})");
  for (const Pose& pose : read_trajectory(route.folder / "out.csv")) {
    CHECK(pose.translation[2] == Approx(4));
    CHECK(pose.rotation[7] == Approx(0.02).epsilon(0.01));
  }
  check_cases([&](const std::string& more) { return route.make(more); },
              {
                  {on + " --force", 2},
                  {"--track 2 --height 3 --force", 2},
                  {on + " --track 2 --force --env " + quoted(site), 2},
                  {on + " --track 12 --force", 3, "no ground was found under the left wheels"},
              });
  check_outcome(route.run("trajectory line " + quoted(route.input) + " " + on +
                          " --track 1 --force -o " + quoted(site)),
                2);
}

TEST_CASE("trajectory line takes the unit of a store") {
  const Route route("x,y\n0,0\n100,0\n");
  route.put("points.xyz", "0 0 0\n1 1 1\n2 1 0\n");
  const auto store_in = [&](const std::string& unit) {
    const auto store = route.folder / (unit + ".h5");
    require_success(route.run("convert points.xyz -o " + quoted(store) + " --unit " + unit));
    return "--height 0 --force --env " + quoted(store);
  };
  const auto last_x = [&] {
    return read_trajectory(route.folder / "out.csv").back().translation[0];
  };
  require_success(route.make(store_in("m")));
  CHECK(last_x() == 100);
  check_outcome(route.make(store_in("us-ft")), 0, "multiplied by 0.30480061 ");
  CHECK(last_x() == Approx(30.48006096).epsilon(1e-9));
  check_outcome(route.make("--height 0 --force --env none.h5"), 4);
}
