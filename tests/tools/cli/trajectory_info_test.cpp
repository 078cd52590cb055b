#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "clearway/trajectory.hpp"
#include "support/bytes/sbet_bytes.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A folder with path.csv, a quarter of a circle of 100 m about (0, 100) that begins along x, with
/// scans and model.xyz.
struct Files : Workplace {
  Files() {
    std::string path = "t,x,y,z,roll_deg,pitch_deg,heading_deg\n";
    std::string scan;
    for (int i = 0; i <= 90; ++i) {
      const double a = i * 3.14159265358979 / 180;
      const std::string place =
          std::to_string(100 * std::sin(a)) + "," + std::to_string(100 - 100 * std::cos(a)) + ",";
      path += std::to_string(0.5 * i) + "," + place + "5,0,0," + std::to_string(90 - i) + "\n";
      scan += place + std::to_string(i % 10) + "\n";
    }
    put("path.csv", path);
    put("scan.xyz", scan);
    put("far.xyz", "10000 10000 0\n10001 10001 1\n");
    put("model.xyz", "-1 -1 0\n3 1 1\n");
  }

  Outcome info(const std::string& more) const { return run("trajectory info " + more); }
  void convert(const std::string& scan, const std::string& store) const {
    require_success(run("convert " + scan + " -o " + store));
  }
};

}  // namespace

TEST_CASE("trajectory info says what was understood") {
  const Files files;
  const Outcome text = require_success(files.info("path.csv"));
  check_says(text.out, "format       csv");
  check_says(text.out, "0.000 0.000 5.000; heading 90.0 degrees (most along x)");
  check_says(text.out, "45 s, 3.49 m/s");
  check_says(text.out, "x of the poses' frame points along the motion");
  check_says(text.err, "clockwise from the map's north");

  const Outcome outcome = require_success(files.info("path.csv --json"));
  const auto json = json_of(outcome);
  check_json(json, R"({
    "poses": 91, "duration_seconds": 45, "up": {"axis": "z"}, "forward": {"axis": "x"},
    "warnings": []})");
  check_near(json, "/length", 157.08, 0.01);
  check_near(json, "/total_turn_degrees", 90);
  check_near(json, "/largest_turn/degrees", 1);
  check_near(json, "/last_pose/heading_degrees", 0, 1e-9);
  CHECK(codes_in(json["notes"]) == std::vector<std::string>{"angle-frame"});
}

TEST_CASE("trajectory info compares with a scan and a model") {
  const Files files;
  files.convert("scan.xyz", "site.h5");
  files.convert("far.xyz", "far.h5");
  const auto met = json_of(files.info("path.csv --env site.h5 --json"));
  CHECK(met["environment"]["poses_inside"].get<int>() >= 90);
  check_json(met, R"({"environment": {"distance": 0}, "warnings": []})");
  const auto far = json_of(files.info("path.csv --env far.h5 --json"));
  check_json(far, R"({"environment": {"poses_inside": 0}})");
  CHECK(far["environment"]["distance"].get<double>() > 10'000);
  CHECK(codes_in(far["warnings"]) == std::vector<std::string>{"path-outside-scan"});

  const std::string model = "path.csv --model model.xyz --json --radius ";
  const auto wide = json_of(files.info(model + "2"));
  check_json(wide, R"({"steps_above_radius": 0, "warnings": []})");
  CHECK(wide["largest_motion"].get<double>() > 1.74);
  const auto narrow = json_of(files.info(model + "0.1"));
  check_json(narrow, R"({"steps_above_radius": 90})");
  CHECK(codes_in(narrow["warnings"]) == std::vector<std::string>{"steps-above-radius"});
  check_outcome(files.info("path.csv --radius 1"), 2);
}

TEST_CASE("trajectory info tells a gap from steps that are all long") {
  const Files files;
  std::string gap;
  for (int i = 0; i < 60; ++i) {
    gap += pose_at(i < 30 ? i * 0.5 : 10 + i * 0.5);
  }
  files.put("gap.txt", gap);
  const auto plain = json_of(files.info("gap.txt --json"));
  CHECK(codes_in(plain["warnings"]) == std::vector<std::string>{"trajectory-jump"});
  const auto both = json_of(files.info("gap.txt --json --model model.xyz --radius 0.1"));
  CHECK(codes_in(both["warnings"]) ==
        std::vector<std::string>{"trajectory-jump", "steps-above-radius"});
  check_json(both, R"({"steps_above_radius": 59, "warnings": {"1": {"numbers": {"steps": 58}}}})");
  const auto large = json_of(files.info("gap.txt --json --model model.xyz --radius 12"));
  check_json(large, R"({"warnings": []})");
}

TEST_CASE("trajectory info warns of other axes, and takes an empty file") {
  const Files files;
  std::string camera;
  for (int i = 0; i < 50; ++i) camera += "1 0 0 0 0 1 0 0 0 0 1 " + std::to_string(i) + "\n";
  files.put("camera.txt", camera);
  const auto json = json_of(files.info("camera.txt --json"));
  CHECK(codes_in(json["warnings"]) == std::vector<std::string>{"forward-axis"});
  files.put("empty.txt", "");
  const auto empty = json_of(files.info("empty.txt --json"));
  check_json(empty, R"({"poses": 0})");
  check_outcome(files.info("empty.txt"), 0);
}

TEST_CASE("options of trajectories reach the reader") {
  const Files files;
  files.put("path.sbet", SbetRecord().bytes());
  check_says(files.info("path.sbet").err, "--trajectory-crs EPSG:25832");
  check_outcome(files.info("path.sbet"), 3);
  check_outcome(files.info("path.sbet --trajectory-crs EPSG:0"), 2);
  const auto sbet = json_of(files.info("path.sbet --trajectory-crs EPSG:32632 --json"));
  check_says(sbet["crs"].get<std::string>(), "UTM zone 32N");
  files.put("yaw.csv", "x,y,z,roll,pitch,yaw\n1000,2000,3000,0,0,0.5\n");
  check_says(files.info("yaw.csv").err, "--angles");
  const auto yaw = json_of(
      files.info("yaw.csv --angles rad,enu --trajectory-unit mm --lever-arm 1,0,-1 --json"));
  check_near(yaw, "/first_pose/position/0", 1 - std::cos(0.5));
  check_json(yaw, R"({"first_pose": {"position": {"2": 4}}})");
  check_cases([&](const std::string& more) { return files.info(more); },
              {
                  {"yaw.csv --angles rad,deg", 2},
                  {"yaw.csv --angles gon", 2},
                  {"yaw.csv --lever-arm 1,2", 2},
                  {"yaw.csv --trajectory-unit km", 2},
              });
}

TEST_CASE("run takes a trajectory's latitudes in the CRS of the store") {
  const Files files;
  files.put("path.sbet", SbetRecord().bytes());
  files.convert("scan.xyz", "site.h5");
  const std::string command =
      "run --env site.h5 --model model.xyz --trajectory path.sbet -o o.h5 --radius 0.1 ";
  check_outcome(files.run(command), 3);  // the store has no CRS
  check_outcome(files.run(command + "--trajectory-crs EPSG:32632"), 0, "heights are ellipsoidal");
}
