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

/// The output of another project's program about a file; empty where the program is not installed.
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
        "nearest_source,encroachment,side,lateral,height,group,depth,points_inside,"
        "obstacle_chainage,shift_left,shift_right,small_groups,small_points");
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
  // Where no conflict is listed, the small groups become topics.
  CHECK_THAT(checked.out, !Contains("none.bcfzip: 0 topics") && !Contains("c.bcf: 0 topics"));
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
  check_refused(work.conflicts("-o " + work.path("c.csv"), "set.h5"), 2,
                "makes a result with first poses");
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
  // The result is the same as with a file that holds only those points.
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
  CHECK(equal.exit_code == 6);
  CHECK_THAT(equal.out, Contains("no new conflicts") && Contains("about the same scan"));
  CHECK(json::parse(compare("out.h5", "out.h5", "--gap 1e-300 --json").out)["new"].empty());
  const Outcome small = work.run("compare " + work.path("fewer.h5") + " " + work.path("out.h5") +
                                 " --conflicts --trajectory " + (work.hall / "trajectory.txt") +
                                 " --min-points 1000000");
  CHECK(small.exit_code == 1);
  CHECK_THAT(small.out, Contains("too small to be listed"));
  const Outcome more = compare("fewer.h5", "out.h5", "--json");
  CHECK(more.exit_code == 1);
  const json all = json::parse(more.out);
  CHECK(all["new"].size() > 0);
  CHECK(all["new"].size() + all["same"].size() == all["b"]["conflicts"]);
  CHECK(all["questions"][0]["what"] == "radius");
  CHECK(all["gone"].size() + all["same"].size() >= all["a"]["conflicts"]);
  const Outcome text = compare("fewer.h5", "out.h5", "--show 1");
  CHECK_THAT(text.out, Contains("queries differ: radius: 0.02 m / 0.1 m") &&
                           Contains("new, only in b: ") && Contains("new conflicts"));
  const json back = json::parse(compare("out.h5", "fewer.h5", "--json").out);
  CHECK(back["gone"].empty());  // a smaller radius does not find them
  CHECK(back["not_searched"].size() >= all["new"].size());
  check_refused(
      work.run("compare " + work.path("out.h5") + " " + work.path("out.h5") + " --conflicts"), 2,
      "--trajectory");
  CHECK(work.run("compare " + work.path("out.h5") + " " + work.path("out.h5") + " --gap 1")
            .exit_code == 2);
}

namespace {

/// A car of four points that drives 20 m along x at a height of 0.5 m, and scans of its
/// surroundings.
struct Street : Work {
  Street() {
    std::string path_text, model_text;
    for (int i = 0; i <= 80; ++i) path_text += line(i);
    put_bytes(folder / "path.txt", path_text);
    for (int i = 0; i <= 40; ++i) half_text += line(i);
    put_bytes(folder / "half.txt", half_text);
    for (const char* corner : {"1 0.5 0.5", "1 -0.5 0.5", "-1 0.5 0.5", "-1 -0.5 0.5"}) {
      model_text += std::string(corner) + "\n";
    }
    put_bytes(folder / "car.xyz", model_text);
    put_bytes(folder / "car.obj",
              "v 1 0.5 0.5\nv 1 -0.5 0.5\nv -1 0.5 0.5\nv -1 -0.5 0.5\nf 1 2 3\nf 2 4 3\n");
  }

  static std::string line(int i) {
    return "1 0 0 " + std::to_string(0.25 * i) + " 0 1 0 0 0 0 1 0\n";
  }

  /// Writes a scan of a post of 200 points with its face at y, and `more` lines.
  void scan(const std::string& name, double y, const std::string& more = "", int seed = 0) const {
    std::string text;
    for (int i = 0; i < 200; ++i) {
      const double shift = 0.001 * ((i * 7 + seed * 13) % 5 - 2);
      text += std::to_string(10 + 0.005 * (i % 20) + shift) + " " + std::to_string(y + shift) +
              " " + std::to_string(0.42 + 0.016 * (i / 20) + shift) + "\n";
    }
    put_bytes(folder / (name + ".xyz"), text + more);
    REQUIRE(run("convert " + path(name + ".xyz") + " -o " + path(name + "_site.h5")).exit_code ==
            0);
  }
  void search(const std::string& site, const std::string& output, const std::string& more = "",
              const std::string& model = "car.xyz", const std::string& along = "path.txt") const {
    const Outcome outcome =
        run("run --env " + path(site + "_site.h5") + " --model " + path(model) + " --trajectory " +
            path(along) + " --radius 0.1 --first-pose -o " + path(output + ".h5") + " " + more);
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
  }
  Outcome compare(const std::string& a, const std::string& b, const std::string& more = "") const {
    return run("compare " + path(a + ".h5") + " " + path(b + ".h5") + " --conflicts --trajectory " +
               path("path.txt") + " " + more);
  }

  std::string half_text;
};

}  // namespace

TEST_CASE("compare --conflicts names every other question, and calls none of them the same") {
  const Street street;
  street.scan("site", 0.55);
  street.search("site", "a", "--clearance 0.2");
  street.search("site", "box", "--clearance 0.2 --ignore-box 0,0,0,20,1,2");
  street.search("site", "half", "--clearance 0.2", "car.xyz", "half.txt");
  street.search("site", "ways", "--between-poses");
  street.search("site", "surface", "--clearance 0.2 --model-as surface", "car.obj");
  const auto differs = [&](const std::string& b, const std::string& what,
                           const std::string& more = "") {
    const Outcome outcome = street.compare("a", b, more);
    INFO(outcome.out + outcome.err);
    CHECK(outcome.exit_code == 1);
    CHECK_THAT(outcome.out,
               Contains("queries differ: " + what) && Contains("--allow-other-question"));
    const json all = json::parse(street.compare("a", b, more + " --json").out);
    CHECK(all["holds"] == false);
    CHECK(all["questions"].size() > 0);
  };
  differs("box", "ignored points");
  differs("half", "trajectory", "--trajectory-b " + street.path("half.txt"));
  differs("ways", "motion");
  differs("surface", "model");
  const Outcome allowed = street.compare("a", "box", "--allow-other-question");
  CHECK(allowed.exit_code == 6);  // the box holds all points
  CHECK_THAT(allowed.out, Contains("which was allowed") && Contains("warned of all-ignored"));
  CHECK(street.compare("a", "ways", "--allow-other-question").exit_code == 0);
  CHECK(street.compare("a", "a").exit_code == 6);
}

TEST_CASE("compare --conflicts tells what became worse, and writes it") {
  const Street street;
  street.scan("before", 0.58);
  street.scan("after", 0.53);
  street.search("before", "a", "--clearance 0.2");
  street.search("after", "b", "--clearance 0.2");
  const Outcome worse = street.compare("a", "b", "-o " + street.path("c.csv"));
  INFO(worse.out + worse.err);
  CHECK(worse.exit_code == 1);
  CHECK_THAT(worse.out,
             Contains("worse by more than 0.02 m: 1") && Contains("1 conflict is worse"));
  CHECK_THAT(street.bytes("c.csv"), Contains("status,id_a,id_b") && Contains("\nworse,1,1,"));
  CHECK(street.compare("b", "a").exit_code == 0);
  CHECK(street.compare("a", "b", "--worse-by 0.1").exit_code == 0);
  CHECK(street.compare("a", "b", "--force -o " + street.path("c.json")).exit_code == 1);
  CHECK(json::parse(street.bytes("c.json"))["worse"].size() == 1);
  CHECK(street.compare("a", "b", "-o " + street.path("c.html")).exit_code == 1);
  CHECK_THAT(street.bytes("c.html"), Contains("<table>") && Contains("worse"));
  check_refused(street.compare("a", "b", "-o " + street.path("c.xml")), 2, "unknown output format");
  check_refused(street.compare("a", "b", "-o " + street.path("c.csv")), 2, "--force");
}

TEST_CASE("compare --conflicts finds a rescan the same, and a new cable") {
  const Street street;
  street.scan("before", 0.55);
  street.scan("again", 0.55, "", 3);
  street.scan("cable", 0.55, "5 0.55 0.5\n5 0.56 0.5\n5 0.57 0.5\n", 3);
  for (const char* name : {"before", "again", "cable"})
    street.search(name, name, "--clearance 0.2");
  const Outcome same = street.compare("before", "again");
  INFO(same.out + same.err);
  CHECK(same.exit_code == 0);
  CHECK_THAT(same.out, Contains("the same in both: 1\n"));
  const Outcome cable = street.compare("before", "cable");
  CHECK(cable.exit_code == 1);
  CHECK_THAT(cable.out, Contains("new groups that are too small to be listed: 1"));
  CHECK(json::parse(street.compare("before", "cable", "--json").out)["new_small"][0]["points"] ==
        3);
  // A cable that both scans have is not new, but one at another place is.
  street.scan("later", 0.55, "5 0.55 0.5\n5 0.56 0.5\n5 0.57 0.5\n", 5);
  street.search("later", "later", "--clearance 0.2");
  CHECK(street.compare("cable", "later").exit_code == 0);
  street.scan("moved", 0.55, "7 0.55 0.5\n7 0.56 0.5\n7 0.57 0.5\n");
  street.search("moved", "moved", "--clearance 0.2");
  CHECK(street.compare("cable", "moved").exit_code == 1);
}

TEST_CASE("conflicts of a few points are told by the headline and by every output") {
  const Street street;
  put_bytes(street.folder / "cable.xyz", "5 0.55 0.5\n5 0.56 0.5\n5 0.57 0.5\n");
  REQUIRE(street.run("convert " + street.path("cable.xyz") + " -o " + street.path("cable_site.h5"))
              .exit_code == 0);
  street.search("cable", "cable");
  std::string outputs;
  for (const char* ending : {"csv", "json", "geojson", "gpkg", "bcf"}) {
    outputs += " -o " + street.path(std::string("c.") + ending);
  }
  const Outcome outcome = street.run("conflicts " + street.path("cable.h5") + " --trajectory " +
                                     street.path("path.txt") + outputs);
  INFO(outcome.out + outcome.err);
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.out, Contains("3 points collide") && Contains("1 group of fewer than 10") &&
                              Contains("5.000 0.560 0.500") && Contains("--min-points 1 lists it"));
  const auto rows = lines_of(street.bytes("c.csv"));
  REQUIRE(rows.size() == 2);
  CHECK_THAT(rows[1], Catch::StartsWith("0,3,0,5,") && Catch::EndsWith(",1,3"));
  CHECK(json::parse(street.bytes("c.json"))["small"][0]["points"] == 3);
  const json features = json::parse(street.bytes("c.geojson"));
  REQUIRE(features["features"].size() == 1);
  CHECK(features["features"][0]["properties"]["shape"] == "small group");
  const std::string package = said_by("ogrinfo", "-so -al " + street.path("c.gpkg"), street);
  if (!package.empty()) CHECK_THAT(package, Contains("Layer name: small_groups"));
  const Outcome checked = run_program_at(CHECK_BCF, street.folder, street.path("c.bcf"));
  CHECK_THAT(checked.out, Contains("c.bcf: 1 topics") || Contains("c.bcf: 1 topic"));
}

TEST_CASE("compare --conflicts calls nothing good where b could not find anything") {
  const Street street;
  street.scan("site", 0.55);
  street.scan("away", 500);
  street.search("site", "a", "--clearance 0.2");
  street.search("away", "off", "--clearance 0.2");
  const Outcome undecided = street.compare("a", "off");
  CHECK(undecided.exit_code == 6);
  CHECK_THAT(undecided.out,
             Contains("no new conflicts; b has not searched 1 place where a has a conflict; b is "
                      "undecided, because its run warned of out-of-reach"));
  const json all = json::parse(street.compare("a", "off", "--json").out);
  CHECK(all["holds"] == false);
  CHECK(all["b"]["verdict"] == "undecided");
  CHECK(all["b"]["doubts"] == json::array({"out-of-reach"}));
  const Outcome before = street.compare("off", "a");
  CHECK(before.exit_code == 1);
  CHECK_THAT(before.out, Contains("; a is undecided, because its run warned of out-of-reach"));
  CHECK_THAT(street.compare("a", "off", "-o " + street.path("u.html")).out, Contains("undecided"));
  CHECK_THAT(street.bytes("u.html"), Contains("b is undecided"));
}

TEST_CASE("compare --conflicts does not call a deeper touch of a surface the same") {
  const Street street;
  street.scan("touch", 0.51);
  street.scan("deep", 0.36);
  street.search("touch", "a", "--clearance 0.2", "car.obj");
  street.search("deep", "b", "--clearance 0.2", "car.obj");
  const Outcome unknown = street.compare("a", "b");
  CHECK(unknown.exit_code == 0);
  CHECK_THAT(unknown.out, Contains("1 conflict of which it is not known whether it is worse"));
  CHECK(json::parse(street.compare("a", "b", "--json").out)["unknown_worse"].size() == 1);
  CHECK_THAT(street.compare("a", "a").out, !Contains("not known"));
  const std::string model = "--model " + street.path("car.obj");
  const Outcome deeper = street.compare("a", "b", model);
  CHECK(deeper.exit_code == 1);
  CHECK_THAT(deeper.out, Contains("1 conflict is worse") && Contains("freed by a shift of 0.0"));
  CHECK(street.compare("b", "a", model).exit_code == 0);
  CHECK(
      street
          .compare("a", "b", model + " -o " + street.path("c.csv") + " -o " + street.path("c.html"))
          .exit_code == 1);
  CHECK_THAT(street.bytes("c.csv"), Contains("\nworse,1,1,") && Contains("freed by a shift"));
  CHECK_THAT(street.bytes("c.html"), Contains("freed by a shift"));
}
