// Scans, paths, models and lengths in feet, and units that nobody named.
#include <cstdio>
#include <nlohmann/json.hpp>

#include "clearway/file_unit.hpp"
#include "io/store/convert/convert.hpp"
#include "support/bytes/las_bytes.hpp"
#include "support/catch.hpp"
#include "support/store_fixture.hpp"
#include "tools/cli/support/program.hpp"

using namespace clearway;
using namespace clearway::test;
using nlohmann::json;

namespace {

std::string text_of(double number) {
  char digits[40];
  std::snprintf(digits, sizeof digits, "%.7f", number);
  return digits;
}

/// A path along x through state plane coordinates, with posts at growing distances beside it.
/// Between feet of 1,200 / 3,937 m and feet of 0.3048 m it would move by 4 m.
struct StatePlane : Workplace {
  static constexpr double kEast = 6'500'000, kNorth = 2'100'000, kHeight = 100;

  /// Writes a scan. unit: the unit in the header. size: how many of that unit a foot of the scene
  /// is.
  void write_scan(const std::string& name, const std::string& unit, double size) const {
    std::string text = "x[" + unit + "],y[" + unit + "],z[" + unit + "]\n";
    for (int i = 0; i < 200; ++i) {
      text += text_of((kEast + 0.1 * i) * size) + "," +
              text_of((kNorth + 0.055 + 0.015 * i) * size) + "," + text_of(kHeight * size) + "\n";
    }
    put(name, text);
  }
  /// Writes the path, with arguments as for write_scan. unit: "" for none.
  void write_path(const std::string& name, const std::string& unit, double size) const {
    const std::string in = unit.empty() ? "" : "[" + unit + "]";
    std::string text = "x" + in + ",y" + in + ",z" + in + ",qx,qy,qz,qw\n";
    for (int i = 0; i < 40; ++i) {
      text += text_of((kEast + 0.5 * i) * size) + "," + text_of(kNorth * size) + "," +
              text_of(kHeight * size) + ",0,0,0,1\n";
    }
    put(name, text);
  }
  void write_model(const std::string& name, double size) const {
    put(name, "0 0 0\n" + text_of(0.25 * size) + " 0 0\n" + text_of(-0.25 * size) + " 0 0\n");
  }

  void convert(const std::string& scan, const std::string& options = "") const {
    require_success(
        Workplace::run("convert " + scan + " -o site.h5 --scale 1e-4 --force " + options));
  }

  Outcome run(const std::string& path, const std::string& model, const std::string& rest) const {
    return require_success(Workplace::run("run --json --force --env site.h5 --trajectory " + path +
                                          " " + model + " " + rest + " -o out.h5"));
  }
  static int found(const Outcome& outcome) { return json_of(outcome)["colliding_points"]; }
};

std::vector<std::string> warnings_in(const Outcome& outcome) {
  return codes_in(json_of(outcome)["warnings"]);
}

bool has(const std::vector<std::string>& codes, const std::string& code) {
  return std::find(codes.begin(), codes.end(), code) != codes.end();
}

std::string geo_keys(const std::vector<std::array<std::uint16_t, 2>>& keys) {
  std::vector<std::uint16_t> words{1, 1, 0, static_cast<std::uint16_t>(keys.size())};
  for (const auto& [key, value] : keys) words.insert(words.end(), {key, 0, 1, value});
  return {reinterpret_cast<const char*>(words.data()), words.size() * 2};
}

}  // namespace

TEST_CASE("a scene in feet has the conflict that it has in metres, whoever names the feet") {
  const StatePlane scene;
  const bool survey = GENERATE(true, false);
  const double metres = survey ? kMetresPerUsSurveyFoot : kMetresPerFoot;
  const std::string exact = survey ? "us-ft" : "ift";
  CAPTURE(exact);
  scene.write_scan("metres.csv", "m", metres);
  scene.write_path("metres_path.csv", "m", metres);
  scene.write_model("metres.xyz", metres);
  scene.convert("metres.csv");
  const Outcome in_metres =
      scene.run("metres_path.csv", "--model metres.xyz", "--radius " + text_of(1.004 * metres));
  const int expected = StatePlane::found(in_metres);
  REQUIRE(expected > 20);
  REQUIRE(expected < 100);

  scene.write_scan("feet.csv", exact, 1);
  scene.convert("feet.csv");
  scene.write_path("plain.csv", "", 1);
  scene.write_path("ft.csv", "ft", 1);
  scene.write_path("exact.csv", exact, 1);
  scene.write_model("feet.xyz", 1);
  const std::string plain = "--model feet.xyz";
  CHECK(StatePlane::found(scene.run("plain.csv", plain, "--radius 1.004")) == expected);
  for (const std::string name : {"ft", exact.c_str()}) {
    CAPTURE(name);
    const Outcome header =
        scene.run(name == "ft" ? "ft.csv" : "exact.csv", plain, "--radius 1.004");
    CHECK(StatePlane::found(header) == expected);
    check_says(header.err, "as the environment is, and are taken as they are");
    CHECK(StatePlane::found(scene.run("plain.csv", plain,
                                      "--radius 1.004 --trajectory-unit " + name)) == expected);
    CHECK(StatePlane::found(scene.run("plain.csv", plain, "--radius 1.004 --model-unit " + name)) ==
          expected);
    CHECK(StatePlane::found(scene.run("plain.csv", plain, "--radius 1.004" + name)) == expected);
    CHECK(StatePlane::found(scene.run("plain.csv", plain, "--radius '1.004 " + name + "'")) ==
          expected);
    scene.put("car.json", R"({"bodies": [{"name": "car", "model": "feet.xyz", "model_unit": ")" +
                              name + R"(", "at": "0)" + name + R"("}]})");
    CHECK(StatePlane::found(scene.run("ft.csv", "--vehicle car.json", "--radius 1.004")) ==
          expected);
  }
  // Metres are still converted, and so is the other foot, which causes a warning.
  CHECK(StatePlane::found(scene.run("metres_path.csv", "--model metres.xyz",
                                    "--model-unit m --radius " + text_of(1.004 * metres) + "m")) ==
        expected);
  const Outcome other =
      scene.run("plain.csv", plain,
                "--radius 1.004 --trajectory-unit " + std::string(survey ? "ift" : "us-ft"));
  CHECK(has(warnings_in(other), "two-feet"));
}

TEST_CASE("a path that a command changes is understood as the given one is") {
  const StatePlane scene;
  scene.write_scan("feet.csv", "us-ft", 1);
  scene.convert("feet.csv");
  scene.write_model("feet.xyz", 1);
  scene.write_path("m.csv", "m", kMetresPerUsSurveyFoot);
  for (const std::string unit : {"ft", "us-ft", "ift"}) scene.write_path(unit + ".csv", unit, 1);
  scene.write_path("plain.csv", "", 1);
  const struct {
    std::string path, option;
    const char* header;  ///< of the changed path, or how its matrices end
  } given[] = {{"m.csv", "", "x [m],y [m],z [m],r00"},
               {"ft.csv", "", "x [ft],"},
               {"us-ft.csv", "", "x [us-ft],"},
               {"ift.csv", "", "x [ift],"},
               {"plain.csv", " --trajectory-unit ft", "x [ft],"},
               {"plain.csv", " --trajectory-unit us-ft", "x [us-ft],"},
               {"plain.csv", "", "given poses ... 0 0 0 1\n"}};
  const std::string changes[] = {
      "resample --max-motion 9 --model feet.xyz", "thin --max-motion 1e-6 --model feet.xyz",
      "smooth --within 1e-3 --step 0.1 --model feet.xyz",
      "resample --max-motion 9 --model feet.xyz --env site.h5", "follow --at 0"};
  for (const auto& [path, option, header] : given) {
    const std::string asked = "--radius 1.004" + option;
    const int expected = StatePlane::found(scene.run(path, "--model feet.xyz", asked));
    CHECK((expected > 20 || path == "ift.csv"));  // which is 13 ft away
    for (const std::string& change : changes) {
      CAPTURE(path, option, change);
      require_success(scene.Workplace::run("trajectory " + change + " " + path + option +
                                           " --force -o new.csv"));
      if (change != "follow --at 0") check_says(scene.bytes("new.csv"), header);
      CHECK(StatePlane::found(scene.run("new.csv", "--model feet.xyz", "--radius 1.004")) ==
            expected);
    }
  }
}

TEST_CASE("models and exports of a result name their unit where it is known") {
  const StatePlane scene;
  scene.write_scan("feet.csv", "us-ft", 1);
  scene.convert("feet.csv");
  scene.write_path("path.csv", "us-ft", 1);
  require_success(scene.Workplace::run("model box 0.2,0.2,0.2 -o box.off"));
  require_success(scene.Workplace::run("model box 0.2,0.2,0.2 -o box.ply"));
  require_success(scene.Workplace::run("model box.off -o points.ply --spacing 0.05"));
  const int expected =
      StatePlane::found(scene.run("path.csv", "--model box:0.2,0.2,0.2", "--radius 0.5"));
  CHECK(expected > 20);
  for (const std::string model : {"box.off", "box.ply"}) {
    CHECK(StatePlane::found(scene.run("path.csv", "--model " + model, "--radius 0.5")) == expected);
  }
  check_says(scene.run("path.csv", "--model points.ply", "--radius 0.5").err,
             "its unit is 1 m, the environment's 0.3048");
  for (const std::string name : {"las", "ply", "xyz", "csv"}) {
    CAPTURE(name);
    const std::string file = "points_of." + name;
    require_success(scene.Workplace::run("export out.h5 --force -o " + file));
    require_success(scene.Workplace::run("convert --force " + file + " -o again.h5"));
    check_json(json_of(run_program(scene.folder, "info --json again.h5")),
               R"({"length_unit": "us-survey-foot"})");
  }
}

TEST_CASE("feet are no warning where every input names its unit") {
  const StatePlane scene;
  scene.write_scan("feet.csv", "us-ft", 1);
  scene.convert("feet.csv");
  scene.write_model("feet.xyz", 1);
  scene.write_path("named.csv", "us-ft", 1);
  scene.write_path("plain.csv", "", 1);
  scene.write_path("metres.csv", "m", kMetresPerUsSurveyFoot);
  const std::string plain = "--model feet.xyz", named = plain + " --model-unit ft";
  CHECK_FALSE(has(warnings_in(scene.run("named.csv", named, "--radius 1ft")), "feet"));
  const Outcome converted = scene.run("metres.csv", named, "--radius 0.3m");
  CHECK_FALSE(has(warnings_in(converted), "feet"));
  check_says(converted.err,
             "positions are in metres and were converted to US survey feet ... name their units");
  check_lacks(converted.err, "to give metres");
  CHECK(has(warnings_in(scene.run("named.csv", named, "--radius 1")), "feet"));
  CHECK(has(warnings_in(scene.run("named.csv", plain, "--radius 1ft")), "feet"));
  CHECK(has(warnings_in(scene.run("plain.csv", named, "--radius 1ft")), "feet"));
}

TEST_CASE("a scan in ft is in the foot of the others") {
  const StatePlane scene;
  scene.write_scan("a.csv", "ft", 1);
  scene.write_scan("b.csv", "us-ft", 1);
  scene.convert("a.csv", "b.csv");
  check_json(json_of(run_program(scene.folder, "info --json site.h5")),
             R"({"length_unit": "us-survey-foot"})");
}

TEST_CASE("another unit than the metre is warned of where the scan names none") {
  const StatePlane scene;
  scene.write_scan("scan.csv", "m", 1);
  std::string bare = scene.bytes("scan.csv");
  bare = bare.substr(bare.find('\n') + 1);
  scene.put("bare.xyz", bare);
  check_says(run_program(scene.folder, "convert bare.xyz -o n.h5").err, "metres are assumed");
  scene.convert("bare.xyz");
  scene.write_path("plain.csv", "", 1);
  scene.write_path("ft.csv", "ft", 1);
  scene.write_path("m.csv", "m", 1);
  scene.write_model("car.xyz", 1);
  const std::string car = "--model car.xyz";
  const auto warned = [&](const std::string& path, const std::string& rest) {
    return has(warnings_in(scene.run(path, car, rest)), "unit-assumed");
  };
  CHECK_FALSE(warned("plain.csv", "--radius 10cm"));
  CHECK_FALSE(warned("m.csv", "--radius 1"));
  CHECK(warned("ft.csv", "--radius 1"));
  CHECK(warned("plain.csv", "--radius 1 --trajectory-unit us-ft"));
  CHECK(warned("plain.csv", "--radius 1 --model-unit in"));
  CHECK(warned("plain.csv", "--radius 1ft"));
  scene.convert("bare.xyz", "--unit m");
  CHECK_FALSE(warned("ft.csv", "--radius 1"));
  CHECK_FALSE(warned("plain.csv", "--radius 1ft --model-unit mm"));
  scene.convert("bare.xyz", "--unit us-ft");
  CHECK_FALSE(warned("ft.csv", "--radius 1"));
  check_outcome(run_program(scene.folder, "convert --unit ft scan.csv -o n.h5 --force"), 3,
                "its unit of length is metre, but foot was given");
}

TEST_CASE("keys and texts that name two units are warned of") {
  const Workplace place;
  LasBytes las;
  las.points = {{0, 0, 0}, {1000, 1000, 1000}};
  // The place is in the unit that the keys name, on the map that they name.
  const auto codes = [&](std::vector<LasBytes::Record> records, double east, double north) {
    las.vlrs = std::move(records);
    las.offset = {east, north, 0};
    place.put("a.las", las.build());
    const Outcome outcome = require_success(place.run("convert --json --force a.las -o a.h5"));
    return warnings_in(outcome);
  };
  const auto keys = [](const std::vector<std::array<std::uint16_t, 2>>& all) {
    return LasBytes::Record{"LASF_Projection", 34735, geo_keys(all)};
  };
  const std::string metre = R"(LOCAL_CS["any",UNIT["metre",1]])";
  CHECK_FALSE(has(codes({keys({{1024, 1}, {3072, 25832}, {3076, 9001}})}, 500'000, 5'300'000),
                  "units-contradict"));
  CHECK_FALSE(has(
      codes({keys({{1024, 1}, {3072, 2230}, {3076, 9003}, {4099, 9003}})}, 6'500'000, 2'100'000),
      "units-contradict"));
  CHECK(has(codes({keys({{1024, 1}, {3072, 25832}, {3076, 9003}})}, 1'640'000, 17'390'000),
            "units-contradict"));
  CHECK(has(codes({keys({{1024, 1}, {3072, 2230}, {3076, 9001}})}, 1'980'000, 640'000),
            "units-contradict"));
  CHECK(has(codes({keys({{1024, 1}, {4099, 9003}})}, 0, 0), "units-contradict"));
  CHECK(has(codes({keys({{1024, 1}, {3076, 9003}}), {"LASF_Projection", 2112, metre}}, 0, 0),
            "units-contradict"));
}

TEST_CASE("scans whose GeoTIFF keys or texts name different systems are warned of by both names") {
  const Workplace place;
  const auto keys = [](std::uint16_t code) {
    return LasBytes::Record{"LASF_Projection", 34735, geo_keys({{1024, 1}, {3072, code}})};
  };
  const auto text = [](const std::string& name, const std::string& code) {
    const std::string authority = code.empty() ? "" : ",AUTHORITY[\"EPSG\",\"" + code + "\"]";
    return LasBytes::Record{
        "LASF_Projection", 2112,
        "PROJCS[\"" + name +
            "\",GEOGCS[\"ETRS89\",DATUM[\"European_Terrestrial_Reference_System_1989\",SPHEROID["
            "\"GRS "
            "1980\",6378137,298.257222101]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0."
            "0174532925199433]],PROJECTION[\"Transverse_Mercator\"],UNIT[\"metre\",1]" +
            authority + "]"};
  };
  const auto warning = [&](const LasBytes::Record& a, const LasBytes::Record& b) {
    LasBytes las;
    las.vlrs = {a};
    place.put("a.las", las.build());
    las.vlrs = {b};
    place.put("b.las", las.build());
    const Outcome outcome =
        require_success(place.run("convert --json --force a.las b.las -o ab.h5"));
    std::string found;
    const json report = json_of(outcome);
    for (const auto& one : report["warnings"]) {
      if (one["code"] == "other-crs") found += one["message"].get<std::string>();
    }
    return found;
  };
  CHECK(warning(keys(25832), keys(25832)).empty());
  check_says(warning(keys(25832), keys(25833)),
             "b.las: another coordinate reference system ( ... EPSG:25833 ... a.las ( ... "
             "EPSG:25832 ... may not fit together");
  CHECK(warning(text("ETRS89 / UTM zone 32N", "25832"), keys(25832)).empty());
  CHECK(warning(keys(25832), text("ETRS89 / UTM zone 32N", "25832")).empty());
  check_says(warning(text("ETRS89 / UTM zone 32N", "25832"), keys(25833)),
             "EPSG:25833 ... ETRS89 / UTM zone 32N, EPSG:25832");
  CHECK(warning(text("one", "25832"), text("the same", "25832")).empty());
  check_says(warning(text("site grid", ""), keys(25833)),
             "EPSG:25833 ... site grid, without an EPSG code");
  check_says(warning(text("one", ""), text("two", "")), "(two, ... (one,");
}
