#include <catch2/catch.hpp>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "clearway/trajectory.hpp"
#include "support/bytes/sbet_bytes.hpp"
#include "support/scenes.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;

namespace {

/// A folder with path.csv, a quarter of a circle of 100 m about (0, 100) that begins along x, with
/// scans and model.xyz.
struct Files {
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
    put_bytes(folder / "path.csv", path);
    put_bytes(folder / "scan.xyz", scan);
    put_bytes(folder / "far.xyz", "10000 10000 0\n10001 10001 1\n");
    put_bytes(folder / "model.xyz", "-1 -1 0\n3 1 1\n");
  }

  /// Runs the program. Words with a dot and a letter behind it are names of files in the folder.
  Outcome run(const std::string& words) const {
    std::istringstream in(words);
    std::string all;
    for (std::string word; in >> word;) {
      const auto dot = word.find('.');
      const bool name = dot != std::string::npos && dot + 1 < word.size() &&
                        std::isalpha(static_cast<unsigned char>(word[dot + 1])) != 0;
      all += (name ? quoted(folder / word) : word) + " ";
    }
    return run_program(folder, all);
  }
  Outcome info(const std::string& more) const { return run("trajectory info " + more); }
  void convert(const std::string& scan, const std::string& store) const {
    REQUIRE(run("convert " + scan + " -o " + store).exit_code == 0);
  }

  ScratchFolder folder;
};

std::vector<std::string> codes_of(const nlohmann::json& messages) {
  std::vector<std::string> codes;
  for (const auto& message : messages) codes.push_back(message["code"]);
  return codes;
}

}  // namespace

TEST_CASE("trajectory info says what was understood") {
  const Files files;
  const Outcome text = files.info("path.csv");
  REQUIRE(text.exit_code == 0);
  CHECK_THAT(text.out, Contains("format       csv"));
  CHECK_THAT(text.out, Contains("0.000 0.000 5.000; heading 90.0 degrees (most along x)"));
  CHECK_THAT(text.out, Contains("45 s, 3.49 m/s"));
  CHECK_THAT(text.out, Contains("x of the poses' frame points along the motion"));
  CHECK_THAT(text.err, Contains("clockwise from the map's north"));

  const Outcome outcome = files.info("path.csv --json");
  REQUIRE(outcome.exit_code == 0);
  const auto json = nlohmann::json::parse(outcome.out);
  CHECK(json["poses"] == 91);
  CHECK(json["length"].get<double>() == Approx(157.08).margin(0.01));
  CHECK(json["duration_seconds"] == 45);
  CHECK(json["total_turn_degrees"].get<double>() == Approx(90));
  CHECK(json["largest_turn"]["degrees"].get<double>() == Approx(1));
  CHECK(json["up"]["axis"] == "z");
  CHECK(json["forward"]["axis"] == "x");
  CHECK(json["last_pose"]["heading_degrees"].get<double>() == Approx(0).margin(1e-9));
  CHECK(json["warnings"].empty());
  CHECK(codes_of(json["notes"]) == std::vector<std::string>{"angle-frame"});
}

TEST_CASE("trajectory info compares with a scan and a model") {
  const Files files;
  files.convert("scan.xyz", "site.h5");
  files.convert("far.xyz", "far.h5");
  const auto met = nlohmann::json::parse(files.info("path.csv --env site.h5 --json").out);
  CHECK(met["environment"]["poses_inside"].get<int>() >= 90);
  CHECK(met["environment"]["distance"] == 0);
  CHECK(met["warnings"].empty());
  const auto far = nlohmann::json::parse(files.info("path.csv --env far.h5 --json").out);
  CHECK(far["environment"]["poses_inside"] == 0);
  CHECK(far["environment"]["distance"].get<double>() > 10'000);
  CHECK(codes_of(far["warnings"]) == std::vector<std::string>{"path-outside-scan"});

  const std::string model = "path.csv --model model.xyz --json --radius ";
  const auto wide = nlohmann::json::parse(files.info(model + "2").out);
  CHECK(wide["steps_above_radius"] == 0);
  CHECK(wide["largest_motion"].get<double>() > 1.74);
  CHECK(wide["warnings"].empty());
  const auto narrow = nlohmann::json::parse(files.info(model + "0.1").out);
  CHECK(narrow["steps_above_radius"] == 90);
  CHECK(codes_of(narrow["warnings"]) == std::vector<std::string>{"steps-above-radius"});
  CHECK(files.info("path.csv --radius 1").exit_code == 2);
}

TEST_CASE("trajectory info tells a gap from steps that are all long") {
  const Files files;
  std::string gap;
  for (int i = 0; i < 60; ++i) {
    gap += "1 0 0 " + std::to_string(i < 30 ? i * 0.5 : 10 + i * 0.5) + " 0 1 0 0 0 0 1 0\n";
  }
  put_bytes(files.folder / "gap.txt", gap);
  const auto plain = nlohmann::json::parse(files.info("gap.txt --json").out);
  CHECK(codes_of(plain["warnings"]) == std::vector<std::string>{"trajectory-jump"});
  const auto both =
      nlohmann::json::parse(files.info("gap.txt --json --model model.xyz --radius 0.1").out);
  CHECK(codes_of(both["warnings"]) ==
        std::vector<std::string>{"trajectory-jump", "steps-above-radius"});
  CHECK(both["steps_above_radius"] == 59);
  CHECK(both["warnings"][1]["numbers"]["steps"] == 58);
  const auto large =
      nlohmann::json::parse(files.info("gap.txt --json --model model.xyz --radius 12").out);
  CHECK(large["warnings"].empty());
}

TEST_CASE("trajectory info warns of other axes, and takes an empty file") {
  const Files files;
  std::string camera;
  for (int i = 0; i < 50; ++i) camera += "1 0 0 0 0 1 0 0 0 0 1 " + std::to_string(i) + "\n";
  put_bytes(files.folder / "camera.txt", camera);
  const auto json = nlohmann::json::parse(files.info("camera.txt --json").out);
  CHECK(codes_of(json["warnings"]) == std::vector<std::string>{"forward-axis"});
  put_bytes(files.folder / "empty.txt", "");
  const auto empty = nlohmann::json::parse(files.info("empty.txt --json").out);
  CHECK(empty["poses"] == 0);
  CHECK(files.info("empty.txt").exit_code == 0);
}

TEST_CASE("options of trajectories reach the reader") {
  const Files files;
  put_bytes(files.folder / "path.sbet", SbetRecord().bytes());
  CHECK_THAT(files.info("path.sbet").err, Contains("--trajectory-crs EPSG:25832"));
  CHECK(files.info("path.sbet").exit_code == 3);
  CHECK(files.info("path.sbet --trajectory-crs EPSG:0").exit_code == 2);
  const auto sbet =
      nlohmann::json::parse(files.info("path.sbet --trajectory-crs EPSG:32632 --json").out);
  CHECK_THAT(sbet["crs"].get<std::string>(), Contains("UTM zone 32N"));
  put_bytes(files.folder / "yaw.csv", "x,y,z,roll,pitch,yaw\n1000,2000,3000,0,0,0.5\n");
  CHECK_THAT(files.info("yaw.csv").err, Contains("--angles"));
  const auto yaw = nlohmann::json::parse(
      files.info("yaw.csv --angles rad,enu --trajectory-unit mm --lever-arm 1,0,-1 --json").out);
  CHECK(yaw["first_pose"]["position"][0].get<double>() == Approx(1 - std::cos(0.5)));
  CHECK(yaw["first_pose"]["position"][2] == 4);
  CHECK(files.info("yaw.csv --angles rad,deg").exit_code == 2);
  CHECK(files.info("yaw.csv --angles gon").exit_code == 2);
  CHECK(files.info("yaw.csv --lever-arm 1,2").exit_code == 2);
  CHECK(files.info("yaw.csv --trajectory-unit km").exit_code == 2);
}

TEST_CASE("run takes a trajectory's latitudes in the CRS of the store") {
  const Files files;
  put_bytes(files.folder / "path.sbet", SbetRecord().bytes());
  files.convert("scan.xyz", "site.h5");
  const std::string command =
      "run --env site.h5 --model model.xyz --trajectory path.sbet -o o.h5 "
      "--radius 0.1 ";
  CHECK(files.run(command).exit_code == 3);  // the store has no CRS
  const Outcome named = files.run(command + "--trajectory-crs EPSG:32632");
  CHECK(named.exit_code == 0);
  CHECK_THAT(named.err, Contains("heights are ellipsoidal"));
}
