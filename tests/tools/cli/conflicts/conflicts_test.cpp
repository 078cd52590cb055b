// clearway conflicts and compare --conflicts, through the built program.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tools/cli/support/hall.hpp"

using namespace clearway;
using namespace clearway::test;
using Catch::Contains;
using nlohmann::json;

namespace {

/// A result of the hall whose conflicts are many and have distances.
struct HallResult : Work {
  HallResult() {
    const Outcome outcome =
        run_hall(hall / "site.h5", "out.h5", "--force --first-pose --clearance 0.2");
    REQUIRE(outcome.exit_code == 0);
  }

  Outcome conflicts(const std::string& options, const std::string& result = "out.h5") const {
    return run("conflicts " + path(result) + " --trajectory " + (hall / "trajectory.txt") + " " +
               options);
  }
  json listed(const std::string& options) const {
    REQUIRE(conflicts("--force -o " + path("listed.json") + " " + options).exit_code == 0);
    return json::parse(bytes("listed.json"));
  }
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

bool is_installed(const char* program) {
  return std::system(("command -v " + std::string(program) + " >/dev/null 2>&1").c_str()) == 0;
}

/// What a program of another project says of a file; empty where the program is not installed.
std::string said_by(const std::string& program, const std::string& arguments, const Work& work) {
  if (!is_installed(program.c_str())) {
    WARN(program << " is not installed: not tested");
    return "";
  }
  const Outcome outcome = run_program_at(program, work.folder, arguments);
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.err, !Contains("ERROR") && !Contains("Warning"));
  return outcome.out;
}

}  // namespace

TEST_CASE("conflicts are listed in JSON and CSV, and no point is lost") {
  const HallResult work;
  const json all = work.listed("--min-points 3 -o " + work.path("listed.csv"));
  REQUIRE(all["conflicts"].size() > 2);
  std::uint64_t points = all["small_points"];
  double chainage = 0;
  std::uint64_t id = 0;
  for (const json& c : all["conflicts"]) {
    CHECK(c["id"] == ++id);
    CHECK(c["chainage_from"] >= chainage);
    chainage = c["chainage_from"];
    points += c["points"].get<std::uint64_t>();
    CHECK(c["points"] >= 1);
    for (int k = 0; k < 3; ++k) {
      CHECK(c["lo"][k] <= c["centroid"][k]);
      CHECK(c["centroid"][k] <= c["hi"][k]);
    }
    CHECK(c["first_pose"] <= c["last_pose"]);
    CHECK(c["least_distance"].get<double>() < 0.1);
    CHECK(c["encroachment"] == 0.1 - c["least_distance"].get<double>());
    CHECK(c["side"] != "unknown");
  }
  CHECK(points == all["colliding_points"]);
  CHECK(all["conflict_count"] == all["conflicts"].size());
  CHECK(all["radius"] == 0.1);
  CHECK(all["gap"] == 0.3);
  CHECK(all["split"] == 25);
  CHECK(all["poses"] == 150);
  CHECK(all["warnings"].is_array());

  const auto rows = lines_of(work.bytes("listed.csv"));
  REQUIRE(rows.size() == 1 + all["conflicts"].size());
  CHECK(rows[0] ==
        "id,points,source,lo_x,lo_y,lo_z,hi_x,hi_y,hi_z,centroid_x,centroid_y,centroid_z,"
        "first_pose,last_pose,chainage_from,chainage_to,least_distance,nearest_pose,"
        "nearest_source,encroachment,side,lateral,height,group,depth,points_inside");
  CHECK_THAT(rows[1], Catch::StartsWith("1," + all["conflicts"][0]["points"].dump() + "," +
                                        all["conflicts"][0]["source"].dump() + ","));
}

TEST_CASE("a table and a summary are printed") {
  const HallResult work;
  const Outcome table = work.conflicts("--show 2 --min-points 3");
  CHECK(table.exit_code == 0);
  CHECK_THAT(table.out, Contains("conflicts of") && Contains("along") && Contains("the worst 2") &&
                            Contains("encroachment (m)") && Contains("not listed: "));
  const json summary = json::parse(work.conflicts("--json").out);
  CHECK(summary["kind"] == "conflicts");
  CHECK(!summary.contains("conflicts"));
  CHECK(json::parse(work.conflicts("--json --gap 10cm --split 2m").out)["gap"] == 0.1);
}

TEST_CASE("threads and the store's cells change no byte of any format") {
  const HallResult work;
  const auto write = [&](const std::string& name, const std::string& more,
                         const std::string& result = "out.h5") {
    std::string outputs;
    for (const char* ending : {"csv", "json", "geojson", "gpkg", "bcf"}) {
      outputs += " -o " + work.path(name + "." + ending);
    }
    REQUIRE(work.conflicts("--min-points 6 " + more + outputs, result).exit_code == 0);
    std::string all;
    for (const char* ending : {"csv", "json", "geojson", "gpkg", "bcf"}) {
      all += work.bytes(name + "." + ending);
    }
    return all;
  };
  const std::string one = write("one", "--threads 1");
  CHECK(write("two", "--threads 2") == one);
  CHECK(write("seven", "--threads 7") == one);
  REQUIRE(work.run("convert " + (work.hall / "environment.las") + " -o " + work.path("other.h5") +
                   " --cell-points 500")
              .exit_code == 0);
  REQUIRE(work.run_hall(work.path("other.h5"), "other_out.h5", "--first-pose --clearance 0.2")
              .exit_code == 0);
  CHECK(write("other", "", "other_out.h5") == one);
  CHECK(write("dated", "--date 2025-03-31") != one);
}

TEST_CASE("GeoJSON and GeoPackage open in GDAL") {
  const HallResult work;
  const json all = work.listed("-o " + work.path("c.geojson") + " -o " + work.path("c.gpkg"));
  const std::string count = all["conflicts"].size() == 0 ? "" : all["conflict_count"].dump();
  REQUIRE(!count.empty());
  const json features = json::parse(work.bytes("c.geojson"));
  CHECK(features["type"] == "FeatureCollection");
  CHECK(features["features"].size() == 2 * all["conflicts"].size());
  CHECK(features["features"][0]["geometry"]["type"] == "Point");
  CHECK(features["features"][1]["geometry"]["type"] == "Polygon");
  CHECK(features["features"][1]["geometry"]["coordinates"][0].size() == 5);
  CHECK(features["crs"]["properties"]["name"] == "LOCAL_CS[\"unknown\",UNIT[\"metre\",1]]");

  const std::string package = said_by("ogrinfo", "-so -al " + work.path("c.gpkg"), work);
  const std::string json_text = said_by("ogrinfo", "-so -al " + work.path("c.geojson"), work);
  if (package.empty() || json_text.empty()) return;
  CHECK_THAT(package,
             Contains("Layer name: conflicts") && Contains("Geometry: 3D Point") &&
                 Contains("Layer name: footprints") && Contains("Geometry: 3D Polygon") &&
                 Contains("Layer name: stretches") && Contains("Geometry: 3D Line String") &&
                 Contains("Feature Count: " + count) && Contains("encroachment: Real") &&
                 Contains("lateral: Real") && Contains("height: Real") && Contains("side: String"));
  CHECK_THAT(json_text, Contains("Feature Count: " + std::to_string(features["features"].size())) &&
                            !Contains("WGS 84"));
  const std::string first = said_by("ogrinfo", work.path("c.gpkg") + " conflicts -fid 1", work);
  CHECK_THAT(first, Contains("POINT Z (") &&
                        Contains("points (Integer64) = " + all["conflicts"][0]["points"].dump()));
}

TEST_CASE("BCF follows its schemas") {
  const HallResult work;
  REQUIRE(work.conflicts("-o " + work.path("c.bcf") + " --min-points 3 --model " +
                         (work.hall / "model.ply"))
              .exit_code == 0);
  REQUIRE(work.conflicts("-o " + work.path("none.bcfzip") + " --min-points 1000000").exit_code ==
          0);
  const Outcome checked =
      run_program_at(CHECK_BCF, work.folder, work.path("c.bcf") + " " + work.path("none.bcfzip"));
  INFO(checked.err);
  CHECK(checked.exit_code == 0);
  CHECK_THAT(checked.out, Contains("none.bcfzip: 0 topics") && !Contains("c.bcf: 0 topics"));
}

TEST_CASE("conflicts of no colliding point are an empty list in every format") {
  const HallResult work;
  REQUIRE(work.run("run --env " + (work.hall / "site.h5") + " --model " +
                   (work.hall / "model.ply") + " --trajectory " + (work.hall / "trajectory.txt") +
                   " --radius 1e-9 --first-pose -o " + work.path("none.h5"))
              .exit_code == 0);
  const Outcome outcome = work.conflicts("-o " + work.path("n.csv") + " -o " + work.path("n.json") +
                                             " -o " + work.path("n.geojson") + " -o " +
                                             work.path("n.gpkg") + " -o " + work.path("n.bcf"),
                                         "none.h5");
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.out, Contains("no conflicts"));
  CHECK(lines_of(work.bytes("n.csv")).size() == 1);
  CHECK(json::parse(work.bytes("n.json"))["conflicts"].empty());
  CHECK(json::parse(work.bytes("n.geojson"))["features"].empty());
  said_by("ogrinfo", "-so -al " + work.path("n.gpkg"), work);
}

TEST_CASE("what conflicts cannot do is refused, and no output is left") {
  const HallResult work;
  REQUIRE(work.run_hall(work.hall / "site.h5", "set.h5").exit_code == 0);
  check_refused(work.conflicts("-o " + work.path("c.csv"), "set.h5"), 2, "run with --first-pose");
  check_refused(work.conflicts("-o " + work.path("c.xml")), 2, "unknown output format");
  check_refused(work.conflicts("--gap 0"), 2, "--gap");
  check_refused(work.conflicts("--split=-1"), 2, "0 or more");
  check_refused(work.conflicts("--split 1e-308"), 2, "or more, or 0 for none");
  check_refused(work.conflicts("--min-points 1.5"), 2,
                "--min-points: 1.5: expected a whole number from 1");
  check_refused(work.conflicts("--min-points 0"), 2, "expected a whole number from 1");
  check_refused(work.conflicts("--chainage-start far"), 2, "--chainage-start");
  check_refused(work.conflicts("--forward +z"), 2, "same axis");
  check_refused(work.conflicts("--date 2025-02-30 -o " + work.path("c.bcf")), 2, "--date");
  check_refused(work.conflicts("--memory 1M"), 4, "--memory");
  put_bytes(work.folder / "other.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  check_refused(work.run("conflicts " + work.path("out.h5") + " --trajectory " +
                         work.path("other.txt") + " -o " + work.path("c.csv")),
                3, "another trajectory");
  put_bytes(work.folder / "other.xyz", "1 2 3\n4 5 6\n");
  check_refused(work.conflicts("--model " + work.path("other.xyz")), 3, "is not the model of");
  for (const char* name : {"c.csv", "c.csv.partial", "c.xml", "c.bcf.partial"}) {
    CHECK_FALSE(std::filesystem::exists(work.folder / name));
  }
  put_bytes(work.folder / "kept.csv", "mine");
  check_refused(work.conflicts("-o " + work.path("kept.csv")), 2, "--force");
  CHECK(work.bytes("kept.csv") == "mine");
  check_refused(work.conflicts("--force -o " + work.path("out.h5")), 2, "out.h5");
}

TEST_CASE("model-above leaves out the lowest part of the model, and says how much") {
  const Work work;
  const std::string model = " --trajectory " + (work.hall / "trajectory.txt") + " --env " +
                            (work.hall / "site.h5") + " --model " + (work.hall / "model.ply") +
                            " --radius 0.1 --force -o " + work.path("above.h5") + " --model-above ";
  const auto info = [&] {
    return json::parse(work.run("info --json " + work.path("above.h5")).out);
  };
  const Outcome some = work.run("run" + model + "0.5");
  REQUIRE(some.exit_code == 0);
  CHECK_THAT(some.err, Contains("of 300 model points are below z = 0.5 m, and are left out"));
  const json kept = info();
  CHECK(kept["model_points"] < 300);
  CHECK(kept["model_points"] > 0);
  REQUIRE(work.run("run" + model + "50cm").exit_code == 0);
  CHECK(info()["model_hash"] == kept["model_hash"]);
  REQUIRE(work.run("run" + model + "-1e3").exit_code == 0);
  CHECK(info()["model_points"] == 300);
  check_refused(work.run("run" + model + "1000"), 3, "all 300 points of the model are below");
  // The same points as from a file that has only them.
  REQUIRE(work.run("model " + (work.hall / "model.ply") + " --above 0.5 -o " + work.path("top.ply"))
              .exit_code == 0);
  REQUIRE(work.run("run --env " + (work.hall / "site.h5") + " --model " + work.path("top.ply") +
                   " --trajectory " + (work.hall / "trajectory.txt") + " --radius 0.1 -o " +
                   work.path("top.h5"))
              .exit_code == 0);
  REQUIRE(work.run("run" + model + "0.5").exit_code == 0);
  CHECK(work.bytes("top.h5") == work.bytes("above.h5"));
}

TEST_CASE("compare --conflicts tells new, gone and the same, and exits with 1 on new ones") {
  const HallResult work;
  REQUIRE(work.run("run --env " + (work.hall / "site.h5") + " --model " +
                   (work.hall / "model.ply") + " --trajectory " + (work.hall / "trajectory.txt") +
                   " --radius 0.02 --first-pose -o " + work.path("fewer.h5"))
              .exit_code == 0);
  const auto compare = [&](const std::string& a, const std::string& b, const std::string& more) {
    return work.run("compare " + work.path(a) + " " + work.path(b) + " --conflicts --trajectory " +
                    (work.hall / "trajectory.txt") + " --min-points 1 " + more);
  };
  const Outcome equal = compare("out.h5", "out.h5", "");
  CHECK(equal.exit_code == 0);
  CHECK_THAT(equal.out, Contains("no new conflicts"));
  CHECK(compare("out.h5", "out.h5", "--gap 1e-300").exit_code == 0);
  const Outcome small = work.run("compare " + work.path("fewer.h5") + " " + work.path("out.h5") +
                                 " --conflicts --trajectory " + (work.hall / "trajectory.txt") +
                                 " --min-points 1000000");
  CHECK(small.exit_code == 1);
  CHECK_THAT(small.out, Contains("b has more points in groups that are too small"));
  const Outcome more = compare("fewer.h5", "out.h5", "--json");
  CHECK(more.exit_code == 1);
  const json all = json::parse(more.out);
  CHECK(all["new"].size() > 0);
  CHECK(all["new"].size() + all["same"].size() == all["b"]["conflicts"]);
  CHECK(all["gone"].size() + all["same"].size() == all["a"]["conflicts"]);
  const Outcome text = compare("fewer.h5", "out.h5", "--show 1");
  CHECK_THAT(text.out, Contains("queries differ: radius: 0.02 / 0.1 m") &&
                           Contains("new, only in b: ") && Contains("new conflicts"));
  const json back = json::parse(compare("out.h5", "fewer.h5", "--json").out);
  CHECK(back["gone"].size() == all["new"].size());
  check_refused(
      work.run("compare " + work.path("out.h5") + " " + work.path("out.h5") + " --conflicts"), 2,
      "--trajectory");
  CHECK(work.run("compare " + work.path("out.h5") + " " + work.path("out.h5") + " --gap 1")
            .exit_code == 2);
}
